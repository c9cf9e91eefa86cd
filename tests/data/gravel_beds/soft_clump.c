/* Soft-sphere bed of rigid clumps under a lugged wheel.
 *
 *   soft_clump BED OUT key=value ...
 *
 * Stones are clumps of spheres; every touching pair of spheres has a Hertz-Mindlin contact (normal force
 * 4/3 E* sqrt(R*) d^1.5, damping of Tsuji for restitution e, tangential spring with history, Coulomb limit).
 * The wheel is a cylinder with one box per lug, forward motion and turn prescribed, free vertically.
 * A sphere may touch the rim and any lug at once, each contact with its own history. Stones out of reach
 * of the wheel are held fixed; who is free is decided anew every few millimetres.
 *
 * BED: text, "n" then per stone "mass Ix Iy Iz x y z qw qx qy qz k" and k lines "cx cy cz r" (body frame).
 * OUT: a row per 0.5 ms: vertical acceleration, pull, driving torque, load, axle height less that at the end
 *      of standing, stones touching wheel, rim, lugs, largest overlap so far. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STONES 2500
#define BALLS 10000
#define PAIRS 400000
#define LUGS 28
typedef double real;

static int n, balls, pairs;
static real X[STONES][3], V[STONES][3], W[STONES][3], L[STONES][3], Q[STONES][4], A[STONES][9], M[STONES], J[STONES][3];
static real F[STONES][3], T[STONES][3], X0[STONES][3], Q0[STONES][4], reach[STONES];
static int first[STONES + 1], active[STONES];
static int owner[BALLS], rim_on[BALLS];
static real C[BALLS][3], O[BALLS][3], P[BALLS][3], R[BALLS];
static real wall_history[BALLS][5][3], rim_history[BALLS][3], lug_history[BALLS][LUGS][3];
static unsigned lug_on[BALLS], wall_on[BALLS];
static int pi_[PAIRS], pj[PAIRS], on[PAIRS];
static real history[PAIRS][3], norm_re[PAIRS], norm_me[PAIRS];
static real E = 1e9, mu = 0.6, wall_mu = 0.3, e = 0.4, beta_, dt, skin = 0.002;
static real x0 = -0.16, x1 = 0.4, width = 0.25, depth = 0.12, edge = 1e9;
static real overlap_max;

static inline void cross(const real *a, const real *b, real *c) {
    c[0] = a[1] * b[2] - a[2] * b[1]; c[1] = a[2] * b[0] - a[0] * b[2]; c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Force on body 1; n points to it; v is its velocity relative to the other at the contact. */
static inline void contact(const real *nn, real d, real re, real me, const real *v, real *h, real friction, real *f) {
    real root = sqrt(re * d), kn = 2 * E * root, kt = 0.82 * kn;
    real vn = v[0] * nn[0] + v[1] * nn[1] + v[2] * nn[2];
    real fn = kn * d * (2.0 / 3) - 1.826 * beta_ * sqrt(kn * me) * vn;
    if (fn < 0) fn = 0;
    real ct = 1.826 * beta_ * sqrt(kt * me), hn = 0, t[3], q = 0;
    for (int a = 0; a < 3; a++) { t[a] = v[a] - vn * nn[a]; h[a] += t[a] * dt; hn += h[a] * nn[a]; }
    for (int a = 0; a < 3; a++) { h[a] -= hn * nn[a]; f[a] = -kt * h[a] - ct * t[a]; q += f[a] * f[a]; }
    real limit = friction * fn;
    if (q > limit * limit) {
        q = limit / sqrt(q);
        for (int a = 0; a < 3; a++) f[a] *= q;
        real m = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
        if (m * kt > limit) for (int a = 0; a < 3; a++) h[a] *= limit / (kt * m);
    }
    for (int a = 0; a < 3; a++) f[a] += fn * nn[a];
    if (d > overlap_max) overlap_max = d;
}

static void pose(int i) {
    real w = Q[i][0], x = Q[i][1], y = Q[i][2], z = Q[i][3], *m = A[i];
    m[0] = 1 - 2 * (y * y + z * z); m[1] = 2 * (x * y - w * z); m[2] = 2 * (x * z + w * y);
    m[3] = 2 * (x * y + w * z); m[4] = 1 - 2 * (x * x + z * z); m[5] = 2 * (y * z - w * x);
    m[6] = 2 * (x * z - w * y); m[7] = 2 * (y * z + w * x); m[8] = 1 - 2 * (x * x + y * y);
    for (int b = first[i]; b < first[i + 1]; b++)
        for (int a = 0; a < 3; a++) {
            O[b][a] = m[3 * a] * C[b][0] + m[3 * a + 1] * C[b][1] + m[3 * a + 2] * C[b][2];
            P[b][a] = X[i][a] + O[b][a];
        }
}

static int by_x(const void *a, const void *b) {
    real d = X[*(const int *)a][0] - X[*(const int *)b][0];
    return (d > 0) - (d < 0);
}

/* New list of near pairs of spheres; histories of pairs that stay are kept. */
static void rebuild(real from, real to) {
    static int old_j[PAIRS], start[BALLS + 1], old_on[PAIRS], order[STONES];
    static real old[PAIRS][3];
    static struct { int i, j; } list[PAIRS];
    static int count[BALLS + 1];
    memset(start, 0, sizeof start);
    for (int k = 0; k < pairs; k++) start[pi_[k] + 1]++;
    for (int b = 0; b < balls; b++) start[b + 1] += start[b];
    memcpy(old_j, pj, sizeof(int) * pairs); memcpy(old, history, sizeof(real) * 3 * pairs); memcpy(old_on, on, sizeof(int) * pairs);
    for (int i = 0; i < n; i++) {
        active[i] = X[i][0] > from && X[i][0] < to && X[i][2] > -depth - 0.2;
        if (!active[i]) for (int a = 0; a < 3; a++) V[i][a] = W[i][a] = L[i][a] = 0;
        order[i] = i;
    }
    qsort(order, n, sizeof(int), by_x);
    int m = 0;
    memset(count, 0, sizeof count);
    for (int p = 0; p < n; p++)
        for (int q = p + 1; q < n; q++) {
            int i = order[p], j = order[q];
            if (X[j][0] - X[i][0] > reach[i] + 0.035 + skin) break;
            if (!active[i] && !active[j]) continue;
            real d[3] = {X[i][0] - X[j][0], X[i][1] - X[j][1], X[i][2] - X[j][2]}, r = reach[i] + reach[j] + skin;
            if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > r * r) continue;
            if (i > j) { int s = i; i = j; j = s; }
            for (int a = first[i]; a < first[i + 1]; a++)
                for (int b = first[j]; b < first[j + 1]; b++) {
                    real s = R[a] + R[b] + skin, u = P[a][0] - P[b][0], v = P[a][1] - P[b][1], w = P[a][2] - P[b][2];
                    if (u * u + v * v + w * w < s * s) {
                        if (m >= PAIRS) { fprintf(stderr, "too many pairs\n"); exit(1); }
                        list[m].i = a; list[m++].j = b; count[a + 1]++;
                    }
                }
        }
    for (int b = 0; b < balls; b++) count[b + 1] += count[b];
    for (int k = 0; k < m; k++) {
        int a = list[k].i, b = list[k].j, at = count[a]++;
        pi_[at] = a; pj[at] = b; on[at] = 0; history[at][0] = history[at][1] = history[at][2] = 0;
        norm_re[at] = R[a] * R[b] / (R[a] + R[b]);
        norm_me[at] = M[owner[a]] * M[owner[b]] / (M[owner[a]] + M[owner[b]]);
        for (int q = start[a]; q < start[a + 1]; q++)
            if (old_j[q] == b) { memcpy(history[at], old[q], sizeof(real) * 3); on[at] = old_on[q]; break; }
    }
    pairs = m;
    memcpy(X0, X, sizeof X0); memcpy(Q0, Q, sizeof Q0);
}

static int moved(void) {
    for (int i = 0; i < n; i++) {
        if (!active[i]) continue;
        real q = 0, s = 0;
        for (int a = 0; a < 3; a++) q += (X[i][a] - X0[i][a]) * (X[i][a] - X0[i][a]);
        for (int a = 0; a < 4; a++) s += (Q[i][a] - Q0[i][a]) * (Q[i][a] - Q0[i][a]);
        if (sqrt(q) + 2 * sqrt(s) * reach[i] > 0.35 * skin) return 1;
    }
    return 0;
}

static real arg(int c, char **v, const char *key, real value) {
    for (int i = 3; i < c; i++) { size_t l = strlen(key); if (!strncmp(v[i], key, l) && v[i][l] == '=') value = atof(v[i] + l + 1); }
    return value;
}

int main(int c, char **v) {
    FILE *in = fopen(v[1], "r"), *out = fopen(v[2], "w");
    if (!in || !out || fscanf(in, "%d", &n) != 1) return 1;
    for (int i = 0; i < n; i++) {
        int k; first[i] = balls;
        if (fscanf(in, "%lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %d", &M[i], J[i], J[i] + 1, J[i] + 2, X[i], X[i] + 1, X[i] + 2, Q[i], Q[i] + 1, Q[i] + 2, Q[i] + 3, &k) != 12) return 1;
        for (; k--; balls++) {
            if (fscanf(in, "%lf %lf %lf %lf", C[balls], C[balls] + 1, C[balls] + 2, R + balls) != 4) return 1;
            owner[balls] = i;
            real l = sqrt(C[balls][0] * C[balls][0] + C[balls][1] * C[balls][1] + C[balls][2] * C[balls][2]) + R[balls];
            if (l > reach[i]) reach[i] = l;
        }
    }
    first[n] = balls;
    for (int i = 0; i < n; i++) pose(i);
    real rate = arg(c, v, "rate", 32000), speed = arg(c, v, "speed", 0.014), slip = arg(c, v, "slip", 0.1), load = arg(c, v, "load", 100);
    real seconds = arg(c, v, "seconds", 15), stand = arg(c, v, "stand", 1.0), relax = arg(c, v, "relax", 0.3), ww = arg(c, v, "wheel", 0.15);
    real back = arg(c, v, "back", 0.14), ahead = arg(c, v, "ahead", 0.18), ramp = 0.5, mass = 12, rw = 0.14, lh = 0.015, half = 0.0015;
    E = arg(c, v, "E", E); mu = arg(c, v, "mu", mu); wall_mu = arg(c, v, "wall_mu", wall_mu); e = arg(c, v, "e", e);
    x0 = arg(c, v, "x0", x0); x1 = arg(c, v, "x1", x1); width = arg(c, v, "width", 0.25); edge = arg(c, v, "edge", 1e9);
    int check = arg(c, v, "check", 8), free_bed = arg(c, v, "free", 0), show = arg(c, v, "show", 0);   /* free: no wheel; show: heights of stone 0 */
    dt = 1 / rate; beta_ = -log(e) / sqrt(log(e) * log(e) + M_PI * M_PI);
    real wx = 0, wz = 0, wvz = 0, wa = 0, om = speed / (rw * (1 - slip)), al = 2 * M_PI / LUGS, built = -1, zs = 0;
    long steps = (relax + (free_bed ? seconds : stand + ramp + seconds)) * rate, lower = relax * rate;
    real sum[8] = {0}; int block = rate / 2000, in_block = 0, wheel = 0;
    static int seen[STONES], seen_rim[STONES], seen_lug[STONES];
    memset(seen, -1, sizeof seen); memset(seen_rim, -1, sizeof seen_rim); memset(seen_lug, -1, sizeof seen_lug);
    overlap_max = 0;
    for (long s = 0; s < steps; s++) {
        real t = s * dt - relax;
        if (s == lower && !free_bed) {
            wheel = 1; wz = -1; overlap_max = 0;
            for (int b = 0; b < balls; b++) {
                real q = rw + lh + R[b];
                if (fabs(P[b][0]) < q && fabs(P[b][1]) < ww / 2 + R[b] && P[b][2] + sqrt(q * q - P[b][0] * P[b][0]) > wz) wz = P[b][2] + sqrt(q * q - P[b][0] * P[b][0]);
            }
        }
        if (s % check == 0 && (s == 0 || wx - built > 0.004 || (s == lower) || moved())) {
            if (wheel) rebuild(wx - back, wx + ahead); else rebuild(-1e9, 1e9);
            built = wx;
        }
        for (int i = 0; i < n; i++) {
            if (!active[i]) continue;
            F[i][0] = F[i][1] = T[i][0] = T[i][1] = T[i][2] = 0; F[i][2] = -9.81 * M[i];
        }
        for (int k = 0; k < pairs; k++) {
            int a = pi_[k], b = pj[k];
            real nn[3] = {P[a][0] - P[b][0], P[a][1] - P[b][1], P[a][2] - P[b][2]}, q = nn[0] * nn[0] + nn[1] * nn[1] + nn[2] * nn[2], r = R[a] + R[b];
            if (q >= r * r) { if (on[k]) { history[k][0] = history[k][1] = history[k][2] = 0; on[k] = 0; } continue; }
            on[k] = 1; q = sqrt(q);
            int i = owner[a], j = owner[b];
            real d = r - q, ra[3], rb[3], wa_[3], wb[3], vr[3], f[3], ta[3], tb[3];
            for (int m = 0; m < 3; m++) { nn[m] /= q; ra[m] = O[a][m] - nn[m] * (R[a] - d / 2); rb[m] = O[b][m] + nn[m] * (R[b] - d / 2); }
            cross(W[i], ra, wa_); cross(W[j], rb, wb);
            for (int m = 0; m < 3; m++) vr[m] = V[i][m] + wa_[m] - V[j][m] - wb[m];
            contact(nn, d, norm_re[k], norm_me[k], vr, history[k], mu, f);
            cross(ra, f, ta); cross(rb, f, tb);
            for (int m = 0; m < 3; m++) { F[i][m] += f[m]; F[j][m] -= f[m]; T[i][m] += ta[m]; T[j][m] -= tb[m]; }
        }
        real fz = 0, fx = 0, torque = 0, vx = 0, ow = 0; int touch = 0, touch_rim = 0, touch_lug = 0;
        if (wheel && t > stand) { real q = t - stand, g = q < ramp ? 0.5 - 0.5 * cos(M_PI * q / ramp) : 1; vx = speed * g; ow = om * g; }
        for (int i = 0; i < n; i++) {
            if (!active[i]) continue;
            for (int b = first[i]; b < first[i + 1]; b++) {
                real beyond = P[b][0] - edge, up = P[b][2] + depth;      /* the floor may end in an edge that stones fall over */
                real gap[5] = {beyond < 0 ? (edge < 1e8 && up < 0 ? 1 : up) : up > 0 ? sqrt(beyond * beyond + up * up) : 1, P[b][1] + width / 2, width / 2 - P[b][1], P[b][0] - x0, x1 - P[b][0]};
                for (int w = 0; w < 5; w++) {
                    if (gap[w] >= R[b] || gap[w] < -R[b]) { if (wall_on[b] >> w & 1) { memset(wall_history[b][w], 0, sizeof(real) * 3); wall_on[b] &= ~(1u << w); } continue; }
                    wall_on[b] |= 1u << w;
                    real nn[3] = {0, 0, 0}, ra[3], wv[3], vr[3], f[3], ta[3];
                    if (w == 0) { nn[2] = 1; if (beyond > 0) { nn[0] = beyond / gap[0]; nn[2] = up / gap[0]; } } else if (w == 1) nn[1] = 1; else if (w == 2) nn[1] = -1; else if (w == 3) nn[0] = 1; else nn[0] = -1;
                    for (int m = 0; m < 3; m++) ra[m] = O[b][m] - nn[m] * gap[w];
                    cross(W[i], ra, wv);
                    for (int m = 0; m < 3; m++) vr[m] = V[i][m] + wv[m];
                    contact(nn, R[b] - gap[w], R[b], M[i], vr, wall_history[b][w], w == 1 || w == 2 ? wall_mu : mu, f);
                    cross(ra, f, ta);
                    for (int m = 0; m < 3; m++) { F[i][m] += f[m]; T[i][m] += ta[m]; }
                }
                if (!wheel) continue;
                real dx = P[b][0] - wx, dz = P[b][2] - wz, rr = dx * dx + dz * dz, lim = rw + lh + R[b], y = P[b][1];
                real yc = y > ww / 2 ? ww / 2 : y < -ww / 2 ? -ww / 2 : y, off = y - yc;
                if (rr > lim * lim || fabs(off) > R[b]) {
                    if (rim_on[b]) { memset(rim_history[b], 0, sizeof(real) * 3); rim_on[b] = 0; }
                    if (lug_on[b]) { memset(lug_history[b], 0, sizeof lug_history[b]); lug_on[b] = 0; }
                    continue;
                }
                rr = sqrt(rr);
                int k0 = (int)floor((atan2(dx, -dz) + wa) / al + 0.5);
                for (int g = -2; g < 2; g++) {      /* rim, then three lugs */
                    real nn[3], p[3], d, q, *h; int lug = -1;
                    if (g == -2) {
                        q = rr - rw; d = sqrt(q * q + off * off);
                        if (q < 0) { if (off != 0) { d = fabs(off); q = 0; } else d = q; }
                        if (d >= R[b]) { if (rim_on[b]) { memset(rim_history[b], 0, sizeof(real) * 3); rim_on[b] = 0; } continue; }
                        nn[0] = q * dx / rr / d; nn[2] = q * dz / rr / d; nn[1] = off / d; h = rim_history[b]; rim_on[b] = 1;
                        if (d < 0) { nn[0] = dx / rr; nn[2] = dz / rr; nn[1] = 0; }
                    } else {
                        int k = k0 + g; lug = ((k % LUGS) + LUGS) % LUGS;
                        real la = k * al - wa, er[2] = {sin(la), -cos(la)}, et[2] = {cos(la), sin(la)};
                        real pr = dx * er[0] + dz * er[1], pt = dx * et[0] + dz * et[1];
                        real cr = pr < rw - 0.01 ? rw - 0.01 : pr > rw + lh ? rw + lh : pr, ct = pt < -half ? -half : pt > half ? half : pt;
                        real qr = pr - cr, qt = pt - ct;
                        d = sqrt(qr * qr + qt * qt + off * off);
                        if (d >= R[b] || d < 1e-9) { if (lug_on[b] >> lug & 1) { memset(lug_history[b][lug], 0, sizeof(real) * 3); lug_on[b] &= ~(1u << lug); } continue; }
                        nn[0] = (qr * er[0] + qt * et[0]) / d; nn[2] = (qr * er[1] + qt * et[1]) / d; nn[1] = off / d;
                        h = lug_history[b][lug]; lug_on[b] |= 1u << lug;
                    }
                    real ra[3], wv[3], vr[3], f[3], ta[3];
                    for (int m = 0; m < 3; m++) { ra[m] = O[b][m] - nn[m] * d; p[m] = P[b][m] - nn[m] * d; }
                    p[0] -= wx; p[2] -= wz;
                    cross(W[i], ra, wv);
                    vr[0] = V[i][0] + wv[0] - (vx + ow * p[2]); vr[1] = V[i][1] + wv[1]; vr[2] = V[i][2] + wv[2] - (wvz - ow * p[0]);
                    contact(nn, R[b] - d, R[b], M[i], vr, h, mu, f);
                    cross(ra, f, ta);
                    for (int m = 0; m < 3; m++) { F[i][m] += f[m]; T[i][m] += ta[m]; }
                    fx -= f[0]; fz -= f[2]; torque += p[2] * f[0] - p[0] * f[2];
                    int now = (int)(s & 0x7fffffff);
                    if (seen[i] != now) { seen[i] = now; touch++; }
                    if (lug < 0 && seen_rim[i] != now) { seen_rim[i] = now; touch_rim++; }
                    if (lug >= 0 && seen_lug[i] != now) { seen_lug[i] = now; touch_lug++; }
                }
            }
        }
        real drag = t < 0.05 - relax ? 400 : t < 0 ? 5 : 0;
        for (int i = 0; i < n; i++) {
            if (!active[i]) continue;
            real l[3], w[3], k = 1 - drag * dt;
            for (int a = 0; a < 3; a++) { V[i][a] = (V[i][a] + F[i][a] / M[i] * dt) * k; X[i][a] += V[i][a] * dt; L[i][a] = (L[i][a] + T[i][a] * dt) * k; }
            real *m = A[i];
            for (int a = 0; a < 3; a++) l[a] = (m[a] * L[i][0] + m[3 + a] * L[i][1] + m[6 + a] * L[i][2]) / J[i][a];
            for (int a = 0; a < 3; a++) w[a] = W[i][a] = m[3 * a] * l[0] + m[3 * a + 1] * l[1] + m[3 * a + 2] * l[2];
            real *q = Q[i], g = 0.5 * dt, u[4] = {q[0] - g * (w[0] * q[1] + w[1] * q[2] + w[2] * q[3]), q[1] + g * (w[0] * q[0] + w[1] * q[3] - w[2] * q[2]),
                q[2] + g * (w[1] * q[0] + w[2] * q[1] - w[0] * q[3]), q[3] + g * (w[2] * q[0] + w[0] * q[2] - w[1] * q[1])};
            real norm = 1 / sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + u[3] * u[3]);
            for (int a = 0; a < 4; a++) q[a] = u[a] * norm;
            pose(i);
        }
        if (free_bed) { if (show && s % (int)(rate / 1000) == 0) fprintf(out, "%.8g\n", X[0][2]); continue; }
        if (!wheel) continue;
        real az = (fz - load - (t < (stand < 1 ? stand : 1.0) ? 1800 * wvz : 0)) / mass;
        wvz += az * dt; wz += wvz * dt; wx += vx * dt; wa += ow * dt;
        real row[8] = {az, fx, torque, fz, wz, touch, touch_rim, touch_lug};
        for (int a = 0; a < 8; a++) sum[a] += row[a];
        if (++in_block == block) {
            int standing = t <= stand;
            if (standing) zs = wz;
            if (t > stand + ramp || (show && standing)) {
                for (int a = 0; a < 8; a++) fprintf(out, "%.6g ", a == 4 ? sum[a] / block - (show ? 0 : zs) : sum[a] / block);
                fprintf(out, "%.3g\n", overlap_max);
            }
            memset(sum, 0, sizeof sum); in_block = 0;
        }
    }
    if (free_bed && !show) for (int i = 0; i < n; i++) { real top = -1e9; for (int b = first[i]; b < first[i + 1]; b++) if (P[b][2] + R[b] > top) top = P[b][2] + R[b]; fprintf(out, "%.6g %.6g %.6g %.6g %.6g %.3g\n", X[i][0], X[i][1], X[i][2], top, M[i], sqrt(V[i][0] * V[i][0] + V[i][1] * V[i][1] + V[i][2] * V[i][2])); }
    fclose(out);
    return 0;
}
