use super::*;

/// What differs between two levels.
fn changes(before: Levels, fault: fn(&mut Levels)) -> usize {
    let mut after = before;
    fault(&mut after);
    let numbers = |l: &Levels| {
        [
            l.building_m,
            l.plane_m,
            l.eaves_m,
            l.changed,
            l.relief,
            l.clutter,
            l.outliers,
            l.noise_px,
            l.bend,
            l.points as f64,
        ]
    };
    let flags = |l: &Levels| [l.lids, l.ground, l.cameras];
    let of_numbers = numbers(&before).iter().zip(numbers(&after)).filter(|(a, b)| **a != *b).count();
    of_numbers + flags(&before).iter().zip(flags(&after)).filter(|(a, b)| **a != *b).count()
}

#[test]
fn every_fault_is_one_fault_and_has_its_own_name() {
    let faults: Vec<usize> = Levels::FAULTS.iter().map(|(_, fault)| changes(Levels::good(), *fault)).collect();
    assert_eq!(faults[0], 0);
    assert!(faults[1..].iter().all(|count| *count == 1), "{faults:?}");
    for list in [Levels::FAULTS, Levels::CURES] {
        let names: std::collections::BTreeSet<&str> = list.iter().map(|(name, _)| *name).collect();
        assert_eq!(names.len(), list.len());
    }
}

#[test]
fn cures_take_faults_away_and_add_none() {
    for seed in 0..50 {
        let drawn = Levels::drawn(&mut Random::stream(seed, 0));
        for (name, cure) in &Levels::CURES[..Levels::CURES.len() - 1] {
            let mut cured = drawn;
            cure(&mut cured);
            let size = |l: &Levels| {
                l.building_m
                    + l.plane_m
                    + l.eaves_m
                    + l.changed
                    + l.relief
                    + l.clutter
                    + l.outliers
                    + l.noise_px
                    + l.bend
                    + f64::from(u8::from(l.lids))
                    + f64::from(u8::from(!l.ground))
                    + f64::from(u8::from(!l.cameras))
            };
            assert!(size(&cured) <= size(&drawn), "{name}");
            assert!(changes(drawn, *cure) <= 1, "{name}");
        }
    }
}

#[test]
fn drawn_levels_take_every_value_of_theirs() {
    let drawn: Vec<Levels> = (0..600).map(|seed| Levels::drawn(&mut Random::stream(seed, 0))).collect();
    for value in [0.03, 0.1, 0.25] {
        assert!(drawn.iter().any(|l| l.building_m == value));
    }
    assert!(drawn.iter().all(|l| (630..=5000).contains(&l.points)));
    let share = |is: fn(&Levels) -> bool| drawn.iter().filter(|l| is(l)).count() as f64 / 600.0;
    assert!((share(|l| l.cameras) - 0.65).abs() < 0.08 && (share(|l| l.lids) - 0.15).abs() < 0.06);
}
