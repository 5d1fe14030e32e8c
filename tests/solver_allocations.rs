//! No minimal solver touches the heap.

use cityweld::solvers::scene::{Random, sample, up};
use cityweld::solvers::{RIGID, SIMILARITY, Sought, UPRIGHT_RIGID, UPRIGHT_SIMILARITY, solve_minimal};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// The library forbids unsafe code; a counting allocator cannot do without.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn no_minimal_solver_allocates() {
    let mut random = Random::stream(5, 0);
    let vertical = up(&mut random);
    let families = [
        (Sought::Rigid, &RIGID[..]),
        (Sought::Similarity, &SIMILARITY[..]),
        (Sought::UprightRigid(vertical), &UPRIGHT_RIGID[..]),
        (Sought::UprightSimilarity(vertical), &UPRIGHT_SIMILARITY[..]),
    ];
    for (sought, configurations) in families {
        for configuration in configurations {
            let points = configuration.points_per_plane;
            let samples: Vec<_> = (0..300).map(|_| sample(&mut random, &sought, points).rows).collect();
            let before = ALLOCATIONS.with(Cell::get);
            let poses: usize = samples.iter().map(|rows| solve_minimal(&sought, points, rows).len()).sum();
            assert_eq!(ALLOCATIONS.with(Cell::get), before, "{points:?} allocates");
            assert!(poses > 0);
        }
    }
}
