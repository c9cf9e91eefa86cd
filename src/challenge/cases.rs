//! The cases of an order, drawn from its seed.
//!
//! Each set is a list in which every prefix is balanced over effects and magnitudes; an order for fewer cases
//! takes prefixes, in proportion to the size of each set. Cases are then shuffled, so that their numbers are
//! uninformative.

use super::design::Design;
use super::frozen::{Frozen, frozen};
use super::order::{Family, Order, Selection, Set};
use super::truth::{Hidden, Level, Rig, Truth};
use super::{ChallengeError, GROUNDS};
use crate::effects::{Application, Form};
use crate::quantity::hexadecimal;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

/// Cases with nothing withheld.
const NOTHING: usize = 120;
/// Cases with two effects.
const PAIRS: usize = 60;
/// Cases of an effect at one magnitude, in each form; twice as many where it has one form only.
const REPEATS: usize = 3;
/// Cases for calibration where their number is not given.
const CALIBRATION: usize = 300;

/// How the rig differs, in turn: a half plainly, a third in the tails, a sixth in its variability.
const RIGS: [Rig; 6] = [
    Rig::Plain,
    Rig::Tails,
    Rig::Plain,
    Rig::Variable,
    Rig::Plain,
    Rig::Tails,
];

/// Sets of calibration cases, in turn.
const CALIBRATION_SETS: [Set; 10] = [
    Set::C0,
    Set::C1,
    Set::C0,
    Set::C1,
    Set::C3,
    Set::C0,
    Set::C1,
    Set::C4,
    Set::C0,
    Set::C1,
];

/// A case before it has a number and a seed.
#[derive(Debug, Clone)]
struct Sketch {
    set: Set,
    ground: &'static str,
    rig: Rig,
    effects: Vec<Hidden>,
}

/// An effect on a channel and a ground on which it can be.
#[derive(Debug, Clone, Copy)]
struct Place<'a> {
    ground: &'static str,
    frozen: &'a Frozen,
}

/// The places of one effect in one form.
#[derive(Debug, Clone)]
struct Placed<'a> {
    effect: &'a str,
    places: Vec<Place<'a>>,
}

/// The cases of an order in the order of their numbers.
///
/// # Errors
/// Those of [`Order::check`].
pub(super) fn draw(order: &Order, designs: &[Design]) -> Result<Vec<Truth>, ChallengeError> {
    order.check()?;
    let Selection { family, sets } = &order.selection;
    let table = frozen();
    let hand = Hand {
        order,
        own: placed(&table, designs, Form::Own),
        other: placed(&table, designs, Form::Other),
        grounds: GROUNDS
            .into_iter()
            .filter(|ground| designs.iter().any(|design| design.ground == *ground))
            .collect(),
    };
    let mut sketches = match family {
        Family::Scoring => {
            let lists: Vec<Vec<Sketch>> = sets.iter().map(|set| hand.list(*set)).collect();
            beginnings(lists, order.cases)
        }
        Family::Calibration => hand.calibration(order.cases.unwrap_or(CALIBRATION)),
    };
    sketches.shuffle(&mut hand.rng("places", 0));
    let numbered = (1..).zip(sketches);
    Ok(numbered
        .map(|(number, sketch)| hand.complete(number, sketch, designs))
        .collect())
}

/// Effects with the places in which they can be and change something, in the table's order.
fn placed<'a>(table: &'a [Frozen], designs: &[Design], form: Form) -> Vec<Placed<'a>> {
    let mut found: Vec<Placed> = Vec::new();
    for frozen in table {
        let possible = designs
            .iter()
            .filter(|design| is_possible(frozen, design, form));
        for design in possible {
            let place = Place {
                ground: design.ground,
                frozen,
            };
            match found.iter_mut().find(|it| it.effect == frozen.effect()) {
                Some(known) => known.places.push(place),
                None => found.push(Placed {
                    effect: frozen.effect(),
                    places: vec![place],
                }),
            }
        }
    }
    found
}

/// Whether an effect edits something in the experiments of a design.
fn is_possible(frozen: &Frozen, design: &Design, form: Form) -> bool {
    let effects = frozen
        .levels
        .map(|level| Application::new(&frozen.name, level).and_then(|effect| effect.in_form(form)));
    effects.into_iter().all(|effect| {
        effect.is_ok_and(|effect| {
            let mut scenario = design.scenario.clone();
            let before = scenario.experiment();
            scenario.effects.push(effect);
            let after = scenario.experiment();
            after.is_ok() && after != before
        })
    })
}

/// The beginnings of several lists, `most` cases together, each list by its share.
fn beginnings(lists: Vec<Vec<Sketch>>, most: Option<usize>) -> Vec<Sketch> {
    let total: usize = lists.iter().map(Vec::len).sum();
    let wanted = most.unwrap_or(total).min(total);
    // Largest remainders; the earlier set first where they are equal.
    let exact = |list: &Vec<Sketch>| list.len() * wanted;
    let mut quotas: Vec<usize> = lists
        .iter()
        .map(|list| exact(list) / total.max(1))
        .collect();
    let mut by_remainder: Vec<usize> = (0..lists.len()).collect();
    by_remainder.sort_by_key(|&at| std::cmp::Reverse(exact(&lists[at]) % total.max(1)));
    let left = wanted - quotas.iter().sum::<usize>();
    for &at in by_remainder.iter().take(left) {
        quotas[at] += 1;
    }
    let lists = lists.into_iter().zip(quotas);
    lists
        .flat_map(|(list, quota)| list.into_iter().take(quota))
        .collect()
}

/// What cases are drawn with.
struct Hand<'a> {
    order: &'a Order,
    own: Vec<Placed<'a>>,
    other: Vec<Placed<'a>>,
    grounds: Vec<&'static str>,
}

impl Hand<'_> {
    fn rng(&self, purpose: &str, number: u64) -> ChaCha8Rng {
        let family = self.order.selection.family;
        family.rng(self.order.seed, purpose, number)
    }

    fn list(&self, set: Set) -> Vec<Sketch> {
        match set {
            Set::C0 => (0..NOTHING).map(|at| self.nothing(at)).collect(),
            Set::C1 => {
                let has_other = |it: &Placed| self.other.iter().any(|o| o.effect == it.effect);
                self.singles(&self.own, set, Form::Own, |it| {
                    if has_other(it) { REPEATS } else { 2 * REPEATS }
                })
            }
            Set::C2 => self.singles(&self.other, set, Form::Other, |_| REPEATS),
            Set::C3 => self.left_out(),
            Set::C4 => {
                let mut rng = self.rng("pairs", 0);
                (0..PAIRS).filter_map(|_| self.pair(&mut rng)).collect()
            }
        }
    }

    fn nothing(&self, at: usize) -> Sketch {
        Sketch {
            set: Set::C0,
            // Every kind of rig comes on every ground.
            ground: self.grounds[(at + at / RIGS.len()) % self.grounds.len()],
            rig: RIGS[at % RIGS.len()],
            effects: Vec::new(),
        }
    }

    /// Every effect at every frozen magnitude: each round has every effect once, and the magnitudes
    /// about equally often.
    fn singles(
        &self,
        effects: &[Placed],
        set: Set,
        form: Form,
        repeats: impl Fn(&Placed) -> usize,
    ) -> Vec<Sketch> {
        let mut rng = self.rng("singles", set as u64);
        let decks = self.decks(effects, &mut rng);
        let rounds = 2 * REPEATS * Level::ALL.len();
        let mut list = Vec::new();
        for round in 0..rounds {
            let repeat = round / Level::ALL.len();
            let mut sketches = Vec::new();
            for (at, deck) in decks.iter().enumerate() {
                if repeat >= repeats(deck) {
                    continue;
                }
                let level = (round + at) % Level::ALL.len();
                sketches.push(single(
                    set,
                    form,
                    &deck.at(repeat, level),
                    Level::ALL[level],
                ));
            }
            sketches.shuffle(&mut rng);
            list.extend(sketches);
        }
        list
    }

    fn left_out(&self) -> Vec<Sketch> {
        let mut rng = self.rng("left out", 0);
        let decks = self.decks(&self.own, &mut rng);
        let mut list = Vec::new();
        for round in 0..2 {
            let mut sketches = Vec::new();
            for (at, deck) in decks.iter().enumerate() {
                // Low magnitudes may be too small to be missed.
                let level = 1 + (round + at) % 2;
                sketches.push(single(
                    Set::C3,
                    Form::Own,
                    &deck.at(round, 0),
                    Level::ALL[level],
                ));
            }
            sketches.shuffle(&mut rng);
            list.extend(sketches);
        }
        list
    }

    /// Two effects of one ground, at typical or high magnitudes; none where it has no two.
    fn pair(&self, rng: &mut ChaCha8Rng) -> Option<Sketch> {
        let ground = self.grounds[rng.random_range(0..self.grounds.len())];
        let mut effects = self.on(ground);
        if effects.len() < 2 {
            return None;
        }
        effects.shuffle(rng);
        let hidden = effects[..2].iter().map(|places| {
            let frozen = places[rng.random_range(0..places.len())].frozen;
            let level = Level::ALL[rng.random_range(1..Level::ALL.len())];
            hidden(frozen, Form::Own, level)
        });
        Some(Sketch {
            set: Set::C4,
            ground,
            rig: Rig::Plain,
            effects: hidden.collect(),
        })
    }

    /// The places of each effect on one ground.
    fn on(&self, ground: &str) -> Vec<Vec<Place<'_>>> {
        let places = self.own.iter().map(|it| {
            let here = it.places.iter().filter(|place| place.ground == ground);
            here.copied().collect::<Vec<Place>>()
        });
        places.filter(|places| !places.is_empty()).collect()
    }

    /// The effects with their places in a random order.
    fn decks<'p>(&self, effects: &[Placed<'p>], rng: &mut ChaCha8Rng) -> Vec<Placed<'p>> {
        let mut decks = effects.to_vec();
        for deck in &mut decks {
            deck.places.shuffle(rng);
        }
        decks
    }

    /// Cases of all kinds, with magnitudes from the priors.
    fn calibration(&self, count: usize) -> Vec<Sketch> {
        let drawn = (0..count).filter_map(|at| {
            let mut rng = self.rng("calibration", at as u64);
            let set = CALIBRATION_SETS[at % CALIBRATION_SETS.len()];
            let mut sketch = match set {
                Set::C0 => self.nothing(at / 2),
                Set::C4 => self.pair(&mut rng)?,
                set => {
                    let effect = &self.own[rng.random_range(0..self.own.len())];
                    let place = &effect.places[rng.random_range(0..effect.places.len())];
                    single(set, Form::Own, place, Level::Typical)
                }
            };
            for effect in &mut sketch.effects {
                let application = effect.application().expect("its place allows it");
                effect.magnitude = application.seat().draw(&mut rng);
                effect.level = None;
            }
            Some(sketch)
        });
        drawn.collect()
    }

    fn complete(&self, number: u64, sketch: Sketch, designs: &[Design]) -> Truth {
        let Order {
            selection, seed, ..
        } = self.order;
        let design = designs.iter().find(|design| design.ground == sketch.ground);
        let design = design.expect("cases are drawn on the order's grounds");
        let salt: [u8; 16] = self.rng("salt", number).random();
        Truth {
            case: format!("case_{number:04}"),
            family: selection.family,
            set: sketch.set,
            ground: sketch.ground.to_owned(),
            rig: sketch.rig,
            edits: design.edits(sketch.rig, &mut self.rng("rig", number)),
            effects: sketch.effects,
            seed: selection.family.seed(*seed, number),
            salt: hexadecimal(&salt),
        }
    }
}

impl<'a> Placed<'a> {
    /// The place of a repeat at a magnitude: places take turns within a magnitude, and begin
    /// elsewhere at the next.
    fn at(&self, repeat: usize, level: usize) -> Place<'a> {
        let stride = if self.places.len() > REPEATS {
            REPEATS
        } else {
            1
        };
        self.places[(repeat + stride * level) % self.places.len()]
    }
}

fn single(set: Set, form: Form, place: &Place, level: Level) -> Sketch {
    Sketch {
        set,
        ground: place.ground,
        rig: Rig::Plain,
        effects: vec![hidden(place.frozen, form, level)],
    }
}

fn hidden(frozen: &Frozen, form: Form, level: Level) -> Hidden {
    Hidden {
        name: frozen.name.clone(),
        magnitude: frozen.levels[level as usize],
        unit: frozen.unit.clone(),
        form,
        level: Some(level),
        detectability: None,
        detectability_beside_parameters: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Stage, catalogue};
    use crate::quantity::Seed;
    use crate::scenario::recording::Recording;
    use std::collections::{BTreeMap, BTreeSet};
    use std::ops::ControlFlow;

    fn order(selection: Selection, cases: Option<usize>, seed: u64) -> Order {
        Order {
            selection,
            cases,
            grounds: vec!["sand".to_owned(), "hard".to_owned()],
            duration: None,
            without_detectability: false,
            seed: Seed(seed),
        }
    }

    fn designs(grounds: &[&str], duration: Option<f64>) -> Vec<Design> {
        let read = |ground: &&str| Design::of(ground, duration).unwrap().unwrap();
        grounds.iter().map(read).collect()
    }

    fn drawn(order: &Order) -> Vec<Truth> {
        draw(order, &designs(&["sand", "hard"], None)).unwrap()
    }

    fn all() -> Vec<Truth> {
        drawn(&order(Selection::all(), None, 7))
    }

    /// How often each key comes.
    fn counts<K: Ord>(keys: impl Iterator<Item = K>) -> BTreeMap<K, usize> {
        let mut counts = BTreeMap::new();
        for key in keys {
            *counts.entry(key).or_default() += 1;
        }
        counts
    }

    #[test]
    fn of_cases_with_nothing_withheld_a_third_is_in_the_tails_and_a_sixth_varies_twice_as_much() {
        let cases = all();
        let nothing = cases.iter().filter(|case| case.set == Set::C0);
        let rigs = counts(nothing.clone().map(|case| case.rig));
        assert_eq!(rigs[&Rig::Plain], 60);
        assert_eq!(rigs[&Rig::Tails], 40);
        assert_eq!(rigs[&Rig::Variable], 20);
        assert!(nothing.clone().all(|case| case.effects.is_empty()));
        let by_ground = counts(nothing.map(|case| (case.rig, case.ground.clone())));
        assert!(
            by_ground.values().all(|n| [10, 20, 30].contains(n)),
            "{by_ground:?}"
        );
    }

    #[test]
    fn every_effect_comes_six_times_at_each_magnitude_and_half_of_them_in_its_other_form() {
        let cases = all();
        let singles = cases
            .iter()
            .filter(|case| [Set::C1, Set::C2].contains(&case.set));
        let found = counts(singles.map(|case| {
            let hidden = &case.effects[0];
            (hidden.effect().to_owned(), hidden.level)
        }));
        // Gravel alone has stones to be pressed into.
        let possible = catalogue().filter(|effect| effect.name != "gravel_embedding");
        assert_eq!(found.len(), 3 * possible.count());
        assert!(found.values().all(|n| *n == 6), "{found:?}");
        for case in &cases {
            let form = if case.set == Set::C2 {
                Form::Other
            } else {
                Form::Own
            };
            assert!(case.effects.iter().all(|hidden| hidden.form == form));
        }
    }

    #[test]
    fn a_few_cases_are_spread_over_sets_effects_and_magnitudes() {
        let few = drawn(&order(Selection::all(), Some(70), 7));
        assert_eq!(few.len(), 70);
        let whole = counts(all().iter().map(|case| case.set));
        let total: usize = whole.values().sum();
        for (set, n) in counts(few.iter().map(|case| case.set)) {
            let share = 70.0 * whole[&set] as f64 / total as f64;
            assert!((n as f64 - share).abs() < 1.0, "{set}: {n} of {share}");
        }
        // One round: gravel alone has stones to be pressed into.
        let round = catalogue().count() - 1;
        let singles = drawn(&order("C1".parse().unwrap(), Some(round), 7));
        let effects = counts(
            singles
                .iter()
                .map(|case| case.effects[0].effect().to_owned()),
        );
        assert_eq!(effects.len(), round);
        let levels = counts(singles.iter().map(|case| case.effects[0].level));
        let third = round / Level::ALL.len();
        assert!(
            levels.values().all(|n| [third, third + 1].contains(n)),
            "{levels:?}"
        );
    }

    #[test]
    fn a_case_s_number_is_independent_of_its_set() {
        let cases = all();
        let mean = |set: Set| {
            let places = cases.iter().enumerate().filter(|(_, case)| case.set == set);
            let places: Vec<f64> = places.map(|(at, _)| at as f64).collect();
            (
                places.iter().sum::<f64>() / places.len() as f64,
                places.len() as f64,
            )
        };
        let n = cases.len() as f64;
        for set in Set::ALL {
            let (mean, of_set) = mean(set);
            // Four standard errors of the mean of uniform places.
            let allowed = 4.0 * n / (12.0 * of_set).sqrt();
            assert!((mean - n / 2.0).abs() < allowed, "{set}: {mean} of {n}");
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_truths_and_another_seed_none_of_them() {
        let text = |seed: u64| -> BTreeSet<String> {
            let cases = drawn(&order(Selection::all(), Some(40), seed));
            cases.iter().map(Truth::text).collect()
        };
        assert_eq!(text(1), text(1));
        assert!(text(1).is_disjoint(&text(2)));
        let salts: BTreeSet<String> = all().into_iter().map(|case| case.salt).collect();
        assert_eq!(salts.len(), all().len());
    }

    #[test]
    fn calibration_cases_share_no_seed_rig_or_magnitude_with_scoring_cases() {
        let scoring = all();
        let calibration = drawn(&order(Selection::calibration(), None, 7));
        assert_eq!(calibration.len(), CALIBRATION);
        let seeds =
            |cases: &[Truth]| -> BTreeSet<u64> { cases.iter().map(|it| it.seed.0).collect() };
        assert!(seeds(&scoring).is_disjoint(&seeds(&calibration)));
        for case in &calibration {
            assert_eq!(Family::of(case.seed), Some(Family::Calibration));
            assert!(scoring.iter().all(|other| other.edits != case.edits));
            for hidden in &case.effects {
                assert_eq!(hidden.form, Form::Own);
                assert!(hidden.level.is_none());
                let seat = hidden.application().unwrap().seat();
                assert!(!seat.levels.contains(&hidden.magnitude), "{}", hidden.name);
            }
        }
    }

    #[test]
    fn every_frozen_magnitude_can_be_simulated_in_every_form() {
        // 0.02 s: what an effect edits is built, and the wheel begins to move.
        let designs = designs(&GROUNDS, Some(0.02));
        let go_on = &mut |_: f64| ControlFlow::Continue(());
        // Motions that sensors are tried on; gravel, which takes long, needs none.
        let mut recordings: Vec<Option<Recording>> = vec![None; designs.len()];
        let table = frozen();
        for form in [Form::Own, Form::Other] {
            for frozen in &table {
                let place = designs.iter().position(|it| is_possible(frozen, it, form));
                let Some(place) = place else {
                    // Only another form may be missing.
                    assert_eq!(form, Form::Other, "{}", frozen.name);
                    continue;
                };
                for level in frozen.levels {
                    let effect = Application::new(&frozen.name, level).unwrap();
                    let mut scenario = designs[place].scenario.clone();
                    scenario.effects.push(effect.in_form(form).unwrap());
                    let simulated = match effect.effect().stage {
                        Stage::Sensors => {
                            let sensors = scenario.experiment().unwrap().sensors;
                            let recording = recordings[place].get_or_insert_with(|| {
                                let scenario = &designs[place].scenario;
                                scenario.record(Seed(1), 0, go_on).unwrap()
                            });
                            recording.measure(&sensors).is_ok()
                        }
                        Stage::Physics => scenario.run(Seed(1), 0, go_on).is_ok(),
                    };
                    assert!(simulated, "{effect} on {}", designs[place].ground);
                }
            }
        }
    }
}
