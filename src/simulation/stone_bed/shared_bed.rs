//! Beds that several runs have in common.
//!
//! A pile depends on its recipe alone: the motions of a random rig, the runs that validate an effect and a sweep with common random
//! numbers roll over the same stones. To pour them takes about half of the time of a run of 8 s, so the piles poured last are kept in
//! memory, and a run pours only sections that no other run has.
//!
//! The other way, to keep them in files, would also serve later processes, at a megabyte for ten beds and with a version to watch.
//! Processes that repeat a bed do so at once, so memory it is.

use super::pouring::Pouring;
use super::surface::Floor;
use super::{BedRecipe, Laying};
use crate::terrain::stones::PlacedStone;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard};

/// Number of piles kept: of all runs of a campaign of a hundred. One of a metre has some 200 stones, less than 100 kB.
const KEPT: usize = 128;

/// The piles of this process.
static PILES: Mutex<Piles> = Mutex::new(Piles(VecDeque::new()));

/// The piles used last, the latest first.
struct Piles(VecDeque<Arc<Bed>>);

/// A bed as far as it has been poured.
struct Bed {
    recipe: BedRecipe,
    /// Where it begins, counted along the heading [m].
    start: f64,
    poured: Mutex<Poured>,
}

struct Poured {
    pouring: Pouring,
    sections: Vec<Section>,
}

struct Section {
    /// The stones that became final with it.
    stones: Vec<PlacedStone>,
    /// Position [m] up to which the bed is final with it.
    finished: f64,
}

/// Reads a bed section by section.
pub(super) struct SharedBed {
    bed: Arc<Bed>,
    /// Sections read.
    read: usize,
    finished: f64,
}

impl Bed {
    fn new(recipe: BedRecipe, start: f64) -> Arc<Self> {
        let poured = Mutex::new(Poured {
            pouring: Pouring::new(start),
            sections: Vec::new(),
        });
        Arc::new(Self {
            recipe,
            start,
            poured,
        })
    }
}

impl Piles {
    /// The pile of a recipe that begins at `start` [m], kept or new.
    fn pile(&mut self, recipe: &BedRecipe, start: f64) -> Arc<Bed> {
        let Self(piles) = self;
        let same = |bed: &Arc<Bed>| bed.start == start && bed.recipe == *recipe;
        let known = piles.iter().position(same);
        let known = known.and_then(|place| piles.remove(place));
        let bed = known.unwrap_or_else(|| Bed::new(recipe.clone(), start));
        piles.push_front(Arc::clone(&bed));
        piles.truncate(KEPT);
        bed
    }
}

impl SharedBed {
    /// The bed of a recipe, poured from `start` [m] forward. One on an uneven floor or in soil depends on more than its recipe and
    /// costs little: it is a run's own.
    pub(super) fn of(recipe: &BedRecipe, start: f64) -> Self {
        let is_pile = matches!(recipe.laying, Laying::Pile { .. });
        let bed = if is_pile {
            locked(&PILES).pile(recipe, start)
        } else {
            Bed::new(recipe.clone(), start)
        };
        Self {
            bed,
            read: 0,
            finished: start,
        }
    }

    /// Position [m] up to which the stones read are final.
    pub(super) fn finished(&self) -> f64 {
        self.finished
    }

    /// The stones of the next section, on a `floor` that is the same for all that read the bed.
    pub(super) fn next(&mut self, floor: &Floor) -> Vec<PlacedStone> {
        let mut poured = locked(&self.bed.poured);
        let Poured { pouring, sections } = &mut *poured;
        if sections.len() == self.read {
            sections.push(Section {
                stones: pouring.pour(&self.bed.recipe, floor),
                finished: pouring.finished(),
            });
        }
        let section = &sections[self.read];
        self.read += 1;
        self.finished = section.finished;
        section.stones.clone()
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().expect("no bed panics while it is poured")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use crate::terrain::{SizeRange, Stones};

    fn pile(run: u64) -> BedRecipe {
        let size = SizeRange {
            min: 0.02,
            max: 0.05,
        };
        BedRecipe {
            stones: Stones::crushed(size),
            laying: Laying::Pile { depth: 0.12 },
            wheel_width: 0.15,
            seed: Seed(0x5ba3),
            run,
            number: 0,
        }
    }

    fn floor() -> Floor {
        Arc::new(|_| -0.12)
    }

    /// The stones of two sections.
    fn read(bed: &mut SharedBed) -> Vec<PlacedStone> {
        let stones = [bed.next(&floor()), bed.next(&floor())].concat();
        assert_eq!(bed.finished(), super::super::SECTION);
        stones
    }

    #[test]
    fn a_second_run_on_a_pile_finds_it_poured_and_every_stone_where_pouring_puts_it() {
        let recipe = pile(1);
        let first = read(&mut SharedBed::of(&recipe, 0.0));
        let mut again = SharedBed::of(&recipe, 0.0);
        assert_eq!(locked(&again.bed.poured).sections.len(), 2);
        let second = read(&mut again);
        let mut own = Pouring::new(0.0);
        let poured = [own.pour(&recipe, &floor()), own.pour(&recipe, &floor())].concat();
        assert!(poured.len() > 40);
        assert_eq!(first, poured);
        assert_eq!(second, poured);
    }

    #[test]
    fn runs_with_other_stones_or_another_start_have_piles_of_their_own() {
        let mut piles = Piles(VecDeque::new());
        let mut other = pile(2);
        other.stones.friction *= 0.9;
        let bed = piles.pile(&pile(2), 0.0);
        let others = [pile(3), other].map(|recipe| piles.pile(&recipe, 0.0));
        assert!(Arc::ptr_eq(&bed, &piles.pile(&pile(2), 0.0)));
        assert!(others.iter().all(|other| !Arc::ptr_eq(other, &bed)));
        assert!(!Arc::ptr_eq(&piles.pile(&pile(2), 0.3), &bed));
    }

    #[test]
    fn memory_holds_the_piles_used_last_and_no_more() {
        let mut piles = Piles(VecDeque::new());
        let first = piles.pile(&pile(0), 0.0);
        for run in 1..KEPT as u64 {
            piles.pile(&pile(run), 0.0);
        }
        assert!(Arc::ptr_eq(&first, &piles.pile(&pile(0), 0.0)));
        piles.pile(&pile(1000), 0.0);
        assert_eq!(piles.0.len(), KEPT);
        assert!(Arc::ptr_eq(&first, &piles.pile(&pile(0), 0.0)));
        // The one used longest ago went.
        let second = locked(&piles.pile(&pile(1), 0.0).poured).sections.len();
        assert_eq!(second, 0);
    }
}
