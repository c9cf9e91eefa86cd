//! Sampling instants: delayed, or by an inaccurate clock.

/// Takes a stream at shifted instants: output `m` is the input at `m · stretch - delay`.
///
/// Cubic between samples; the ends are held, and as many samples leave as came.
pub(super) struct Resampler {
    stretch: f64,
    delay: f64,
    buffer: Vec<f64>,
    /// Index in the stream of the buffer's first sample.
    base: usize,
    produced: usize,
}

impl Resampler {
    /// `delay` [samples], `stretch` [-] the true length of a sample in nominal ones. None where
    /// both are neutral.
    pub(super) fn new(delay: f64, stretch: f64) -> Option<Self> {
        (delay != 0.0 || stretch != 1.0).then(|| Self {
            stretch,
            delay,
            buffer: Vec::new(),
            base: 0,
            produced: 0,
        })
    }

    /// Takes samples and appends the outputs that they complete to `out`.
    pub(super) fn push(&mut self, block: &[f64], out: &mut Vec<f64>) {
        self.buffer.extend_from_slice(block);
        let received = self.base + self.buffer.len();
        while self.produced < received && self.position() + 3.0 < received as f64 {
            self.take(out);
        }
        let needed = (self.position() - 1.0).max(0.0) as usize;
        let done = needed.saturating_sub(self.base).min(self.buffer.len());
        self.buffer.drain(..done);
        self.base += done;
    }

    /// Appends the remaining outputs.
    pub(super) fn finish(mut self, out: &mut Vec<f64>) {
        while self.produced < self.base + self.buffer.len() {
            self.take(out);
        }
    }

    fn position(&self) -> f64 {
        self.produced as f64 * self.stretch - self.delay
    }

    fn take(&mut self, out: &mut Vec<f64>) {
        let position = self.position();
        let t = position - position.floor();
        let [a, b, c, d] = [-1.0, 0.0, 1.0, 2.0].map(|step| self.held(position.floor() + step));
        let (u, v, w) = (t + 1.0, t - 1.0, t - 2.0);
        out.push(
            -t * v * w / 6.0 * a + u * v * w / 2.0 * b - u * t * w / 2.0 * c + u * t * v / 6.0 * d,
        );
        self.produced += 1;
    }

    fn held(&self, index: f64) -> f64 {
        let last = self.buffer.len() - 1;
        self.buffer[(index.max(0.0) as usize)
            .saturating_sub(self.base)
            .min(last)]
    }
}

/// Sampling instants of a slow sensor on the grid of physics steps.
pub(super) struct Instants {
    steps_per_reading: f64,
    delay: f64,
    taken: u64,
}

impl Instants {
    /// `delay` [steps].
    pub(super) fn new(steps_per_reading: f64, delay: f64) -> Self {
        Self {
            steps_per_reading,
            delay,
            taken: 0,
        }
    }

    /// If the next instant lies at or before `step`: how far before [steps], below 1. Instants
    /// before the first step are moved to it.
    pub(super) fn due(&mut self, step: u64) -> Option<f64> {
        let position = self.taken as f64 * self.steps_per_reading - self.delay;
        let back = step as f64 - position.max(0.0);
        (back >= 0.0).then(|| {
            self.taken += 1;
            back
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::sine;
    use super::*;

    fn resampled(input: &[f64], delay: f64, stretch: f64) -> Vec<f64> {
        let mut resampler = Resampler::new(delay, stretch).unwrap();
        let mut out = Vec::new();
        for block in input.chunks(64) {
            resampler.push(block, &mut out);
        }
        resampler.finish(&mut out);
        out
    }

    #[test]
    fn a_delay_of_whole_samples_shifts_and_holds_the_first() {
        let input = sine(0.01, 500);
        let out = resampled(&input, 100.0, 1.0);
        assert_eq!(out.len(), 500);
        assert_eq!(out[..100], [input[0]; 100]);
        assert_eq!(out[100..], input[..400]);
    }

    #[test]
    fn broken_delays_and_wrong_clocks_read_the_wave_between_its_samples() {
        for (delay, stretch) in [(12.3, 1.0), (0.0, 1.0003), (7.7, 0.999)] {
            let out = resampled(&sine(0.005, 2000), delay, stretch);
            for (m, found) in out.iter().enumerate().take(1900).skip(20) {
                let position = m as f64 * stretch - delay;
                let wave = libm::sin(std::f64::consts::TAU * 0.005 * position + 0.3);
                // The cubic's error, 3/128 of the fourth difference (2 pi 0.005)^4.
                assert!((found - wave).abs() < 1e-6, "{delay}, {stretch}: {m}");
            }
            assert_eq!(out.len(), 2000);
        }
    }
}
