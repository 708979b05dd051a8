//! Ensembles whose members are shared out over ranks: the bits of one rank, messages as the formulas say, and faults.

use nastic_control::{Reduced, Space, Target, Timeline, Tracking};
use nastic_energy::{MooneyRivlin, Turgor};
use nastic_ensemble::{
    Ensemble, EnsembleError, EnsemblePoint, EnsembleWorkspace, LoadCase, SavedMembers, blocks_of_members,
};
use nastic_fem::{Discretization, Inertia, Scheme, Solid};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Hessian, Lbfgs, Objective, Optimizer, Request, Saved, Trial};
use nastic_team::threads::{Faults, Traffic, run};
use nastic_team::{Shares, ThreadRank, messages_of_sum};
use nastic_uncertainty::risk::{Cvar, Mean, Risk};
use std::collections::BTreeSet;
use std::sync::{Arc, Barrier, Mutex, PoisonError};
use std::time::{Duration, Instant};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

const MEMBERS: usize = 5;

/// Bars of five stiffnesses.
fn bars(risk: impl Risk + 'static) -> Outcome<Ensemble> {
    let disc = Discretization::new(Arc::new(box_mesh([1.0, 0.2, 0.2], [2, 1, 1], CellKind::Hex8)?))?;
    let mut all = Ensemble::new(risk);
    for k in 0..MEMBERS {
        let mu = 0.8e5 + 0.13e5 * k as f64;
        let body = Solid::on(disc.clone())
            .material("body", MooneyRivlin::new(mu, 2e4, 2e5)?)?
            .actuate("body", "turgor", Turgor::new())?
            .clamp("x-")?;
        let longer = Target::position(|x| [1.05 * x[0], x[1], x[2]]);
        let problem = Reduced::new(body).control("turgor", Space::Cell)?.cost(Tracking::surface("x+", longer))?;
        all = all.scenario_of(&format!("s{k}"), 0.2, vec![LoadCase::new("", 1.0, problem)]);
    }
    Ok(all.build()?)
}

/// The problem of a rank.
fn on(rank: ThreadRank, mut all: Ensemble) -> (Arc<ThreadRank>, Ensemble) {
    let team = Arc::new(rank);
    all.share_out(team.clone(), Arc::default(), Arc::default());
    (team, all)
}

fn bits(v: &[f64]) -> Vec<u64> {
    v.iter().map(|x| x.to_bits()).collect()
}

fn start(len: usize) -> Vec<f64> {
    (0..len).map(|i| 1e3 + 500.0 * (i as f64)).collect()
}

/// All that an optimisation says of itself: cost and work of every trial, its end.
fn optimised(all: &Ensemble) -> Outcome<Vec<u64>> {
    let mut seen = Vec::new();
    let mut within = Lbfgs::default().within(Bounds::new(0.0, 1e5)?).max_iterations(4).observe(
        |trial: &Trial<'_, EnsemblePoint>| {
            seen.extend(trial.cost.map(f64::to_bits));
            seen.extend(trial.summary.0.iter().map(|(_, value)| value.to_bits()));
        },
    );
    let best = within.minimize(all, start(all.len()))?;
    drop(within);
    seen.extend(bits(&best.m));
    seen.extend(bits(&best.derivative));
    seen.extend(bits(&best.point.costs));
    Ok(seen)
}

#[test]
fn an_optimisation_has_the_same_bits_on_any_number_of_ranks() -> Outcome {
    for measure in [0.0, 0.6] {
        let problem = || -> Outcome<Ensemble> {
            if measure == 0.0 { bars(Mean) } else { bars(Cvar { level: measure, smoothing: 0.2 }) }
        };
        let serial = optimised(&problem()?)?;
        for size in [1, 2, 3, 4, 7, 64] {
            let found = run(size, &Faults::default(), |rank| {
                let (_team, all) = on(rank, problem().unwrap());
                optimised(&all).unwrap()
            });
            assert!(found.iter().all(|found| *found == serial), "{size} ranks");
        }
    }
    Ok(())
}

#[test]
fn second_derivatives_have_the_same_bits_on_any_number_of_ranks() -> Outcome {
    let product = |all: &Ensemble| -> Vec<u64> {
        let (m, mut workspace) = (start(all.len()), EnsembleWorkspace::default());
        let point = all.evaluate(&m, &Request::default(), &mut workspace).unwrap();
        let v: Vec<f64> = (0..m.len()).map(|i| (i as f64).cos()).collect();
        let product = Objective::hessian_vector(all, &point, &v, Hessian::Exact, &mut workspace).unwrap();
        bits(&product)
    };
    let problem = || bars(Cvar { level: 0.6, smoothing: 0.2 });
    let serial = product(&problem()?);
    for size in [2, 3, 5, 9] {
        let found = run(size, &Faults::default(), |rank| product(&on(rank, problem().unwrap()).1));
        assert!(found.iter().all(|found| *found == serial), "{size} ranks");
    }
    Ok(())
}

/// The formulas of docs/development/messages-of-ranks.md. `of` has the bytes that are sent of a member, at most.
fn exchanged(shares: &Shares, of: usize) -> Traffic {
    let ranks = shares.ranks();
    let rounds = ranks.next_power_of_two().trailing_zeros() as usize;
    Traffic { messages: ranks * rounds, bytes: (ranks - 1) * (12 * ranks + of * shares.members()) }
}

#[test]
fn messages_and_bytes_are_those_of_the_formulas() -> Outcome {
    let (terms, controls) = (1, bars(Mean)?.len());
    for size in [2, 3, 4, 5, 9, 16, 64] {
        let (shares, barrier) = (Shares::even(MEMBERS, size), Barrier::new(size));
        let counted = run(size, &Faults::default(), |rank| {
            let (team, all) = on(rank, bars(Mean).unwrap());
            // all have sent what they had to before anybody looks, and look before anybody goes on
            let seen = || {
                barrier.wait();
                let seen = team.traffic();
                barrier.wait();
                seen
            };
            let mut workspace = EnsembleWorkspace::default();
            let before = seen();
            let mut point = all.evaluate(&start(controls), &Request::default(), &mut workspace).unwrap();
            let evaluated = seen();
            all.derivative(&mut point, &mut workspace).unwrap();
            (before, evaluated, seen())
        });
        for (before, evaluated, derived) in counted {
            let of = |from: Traffic, to: Traffic| (to.messages - from.messages, to.bytes - from.bytes);
            // counts of reports take fewer bytes where they are small
            let assert_within = |found: (usize, usize), messages: usize, exchange: usize, sums: usize, what: &str| {
                assert_eq!(found.0, messages, "{what} on {size} ranks");
                let reports = found.1 - sums;
                assert!(exchange / 2 < reports && reports <= exchange, "{what}: {reports} bytes of {exchange}");
            };
            let Traffic { messages, bytes } = exchanged(&shares, 81 + 8 * terms);
            assert_within(of(before, evaluated), messages, bytes, 0, "an evaluation");
            let (Traffic { messages, bytes }, sums) = (exchanged(&shares, 71), messages_of_sum(&shares));
            assert_within(of(evaluated, derived), messages + sums, bytes, sums * 8 * controls, "a derivative");
        }
    }
    Ok(())
}

#[test]
fn what_one_number_of_ranks_has_saved_any_other_reads() -> Outcome {
    let m = start(bars(Mean)?.len());
    let saved = |all: &Ensemble| {
        let mut workspace = EnsembleWorkspace::default();
        let mut point = all.evaluate(&m, &Request::default(), &mut workspace).unwrap();
        all.derivative(&mut point, &mut workspace).unwrap();
        all.save(&point)
    };
    let serial = saved(&bars(Mean)?);
    for size in [2, 3, 7] {
        let found = run(size, &Faults::default(), |rank| saved(&on(rank, bars(Mean).unwrap()).1));
        let all: Vec<SavedMembers> = found.iter().map(|own| SavedMembers::from_bytes(own).unwrap()).collect();
        let of = |member: usize| all.iter().map(|own| own.0[member].clone()).collect::<Vec<_>>();
        for member in 0..MEMBERS {
            assert_eq!(of(member).iter().filter(|bytes| !bytes.is_empty()).count(), 1, "{size} ranks");
        }
        let whole = SavedMembers((0..MEMBERS).map(|member| of(member).concat()).collect());
        assert_eq!(whole.to_bytes(), serial, "{size} ranks");
        let again = run(size + 1, &Faults::default(), |rank| {
            let (_team, all) = on(rank, bars(Mean).unwrap());
            let point = all.load(&m, &serial, &Request::default()).unwrap();
            let near = Request { near: Some(&point), ..Request::default() };
            let next = all.evaluate(&vec![2e3; m.len()], &near, &mut EnsembleWorkspace::default()).unwrap();
            let whole = all.whole(&next).unwrap().map(|point| all.save(&point));
            (bits(&next.costs), whole)
        });
        let all = bars(Mean)?;
        let point = all.load(&m, &serial, &Request::default())?;
        let near = Request { near: Some(&point), ..Request::default() };
        let next = all.evaluate(&vec![2e3; m.len()], &near, &mut EnsembleWorkspace::default())?;
        assert!(again.iter().all(|(costs, _)| *costs == bits(&next.costs)));
        assert_eq!(again[0].1.as_ref(), Some(&all.save(&next)));
        assert!(again[1..].iter().all(|(_, whole)| whole.is_none()));
    }
    Ok(())
}

/// Turgor that the softest member alone does not bear, at the accuracy asked for.
#[test]
fn a_failed_member_is_the_same_failure_on_all_ranks() -> Outcome {
    let evaluated = |all: &Ensemble| {
        let outcome = all.evaluate(&vec![f64::NAN; all.len()], &Request::default(), &mut EnsembleWorkspace::default());
        let failed = outcome.expect_err("no equilibrium under a pressure that is no number");
        let member = match failed.downcast_ref() {
            Some(EnsembleError::Member { who, .. }) => who.clone(),
            other => panic!("{other:?}"),
        };
        (failed.to_string(), failed.work().clone(), member)
    };
    let serial = evaluated(&bars(Mean)?);
    assert_eq!(serial.2, "s0");
    for size in [2, 3, 9] {
        let found = run(size, &Faults::default(), |rank| evaluated(&on(rank, bars(Mean).unwrap()).1));
        assert!(found.iter().all(|found| *found == serial), "{found:?} instead of {serial:?}");
    }
    Ok(())
}

/// Whichever rank owns which members, the block of the members 0 to 3 and that of the fifth one have the same bytes.
#[test]
fn blocks_of_members_are_the_same_on_any_number_of_ranks() -> Outcome {
    let m = start(bars(Mean)?.len());
    let blocks = |all: &Ensemble, work: Option<[usize; MEMBERS]>| {
        if let Some(work) = work {
            all.share_anew(&work, &[], 1);
        }
        let point = all.evaluate(&m, &Request::default(), &mut EnsembleWorkspace::default()).unwrap();
        let saved = SavedMembers::from_bytes(&all.save(&point)).unwrap();
        all.blocks_of(|index| saved.0[index].clone()).unwrap()
    };
    let serial = blocks(&bars(Mean)?, None);
    assert_eq!(serial.iter().map(|block| block.members.len()).collect::<Vec<_>>(), [4, 1]);
    assert_eq!(blocks_of_members(MEMBERS).collect::<Vec<_>>(), [0..4, 4..5]);
    assert!(serial.iter().flat_map(|block| &block.members).all(|member| !member.is_empty()));
    for size in [2, 3, 7] {
        for work in [None, Some([1, 1, 1, 1, 100]), Some([100, 1, 1, 1, 1])] {
            let found = run(size, &Faults::default(), |rank| blocks(&on(rank, bars(Mean).unwrap()).1, work));
            let mut all: Vec<_> = found.into_iter().flatten().collect();
            all.sort();
            assert!(all == serial, "{size} ranks, {work:?}");
        }
    }
    Ok(())
}

#[test]
fn members_of_an_ensemble_share_equal_vectors() -> Outcome {
    let all = bars(Mean)?;
    let [first, second, ..] = all.members() else { panic!("{MEMBERS} members") };
    let (first, second) = (first.problem(), second.problem());
    assert!(std::ptr::eq(first.solid().supports(), second.solid().supports()));
    assert!(std::ptr::eq(first.solid().dead_load(), second.solid().dead_load()));
    let basis = |problem: &Reduced| problem.layout().blocks()[0].basis.clone();
    assert!(Arc::ptr_eq(&basis(first), &basis(second)));
    // that of another body on the same mesh is its own, with its own forces
    let body = |force: f64| -> Outcome<Reduced> {
        let solid =
            Solid::on(first.solid().discretization().clone())
                .nodal_force(&vec![force; first.solid().dead_load().len()])?;
        Ok(Reduced::new(solid).share_equal_parts())
    };
    let (one, other) = (body(1.0)?, body(2.0)?);
    assert_eq!(
        (one.solid().dead_load()[0], other.solid().dead_load()[0], first.solid().dead_load()[0]),
        (1.0, 2.0, 0.0)
    );
    Ok(())
}

#[test]
fn members_that_move_between_ranks_change_no_bit() -> Outcome {
    let m = start(bars(Mean)?.len());
    let two = |all: &Ensemble, moves: &dyn Fn() -> bool| {
        let mut workspace = EnsembleWorkspace::default();
        let mut point = all.evaluate(&m, &Request::default(), &mut workspace).unwrap();
        all.derivative(&mut point, &mut workspace).unwrap();
        let saved = all.save(&point);
        assert!(moves());
        let point = all.load(&m, &saved, &Request::default()).unwrap();
        let near = Request { near: Some(&point), ..Request::default() };
        let mut next = all.evaluate(&vec![2e3; m.len()], &near, &mut EnsembleWorkspace::default()).unwrap();
        let derivative = all.derivative(&mut next, &mut EnsembleWorkspace::default()).unwrap();
        (bits(&next.costs), bits(&derivative))
    };
    let serial = two(&bars(Mean)?, &|| true);
    for size in [2, 3] {
        for work in [[100, 1, 1, 1, 1], [1, 1, 1, 1, 100]] {
            let found = run(size, &Faults::default(), |rank| {
                let (_team, all) = on(rank, bars(Mean).unwrap());
                two(&all, &|| all.share_anew(&work, &[], 1) && !all.share_anew(&work, &[], 1))
            });
            assert!(found.iter().all(|found| *found == serial), "{size} ranks, {work:?}");
        }
    }
    Ok(())
}

/// Arms that are let go, of five stiffnesses.
fn arms() -> Outcome<Ensemble> {
    let disc = Discretization::new(Arc::new(box_mesh([0.5, 0.05, 0.05], [2, 1, 1], CellKind::Hex8)?))?;
    let mut all = Ensemble::new(Mean);
    for k in 0..MEMBERS {
        let body = Solid::on(disc.clone())
            .material("body", MooneyRivlin::new(0.8e5 + 0.13e5 * k as f64, 2e4, 2e5)?)?
            .actuate("body", "turgor", Turgor::new())?
            .clamp("x-")?
            .inertia(Inertia::new("body", 1000.0))?;
        let longer = Target::position(|x| [1.05 * x[0], x[1], x[2]]);
        let problem = Reduced::new(body)
            .in_time(Timeline::uniform(Scheme::tr_bdf2(), 0.05, 4)?.from_rest())?
            .control("turgor", Space::Cell)?
            .cost(Tracking::surface("x+", longer))?;
        all = all.scenario_of(&format!("s{k}"), 0.2, vec![LoadCase::new("", 1.0, problem)]);
    }
    Ok(all.build()?)
}

/// Cost and derivative behind a move, and the members that were solved for it.
fn moved_motions(
    mut all: Ensemble,
    moves: impl Fn(&Ensemble, &EnsemblePoint) -> bool,
) -> Outcome<(Vec<u64>, Vec<String>)> {
    let (m, solved) = (start(all.len()), Arc::new(Mutex::new(BTreeSet::new())));
    let names = |of: &Mutex<BTreeSet<String>>| std::mem::take(&mut *of.lock().unwrap_or_else(PoisonError::into_inner));
    let heard = solved.clone();
    all.watch_solves(move |who, _| {
        heard.lock().unwrap_or_else(PoisonError::into_inner).insert(who.to_owned());
    });
    let mut workspace = EnsembleWorkspace::default();
    let mut point = all.evaluate(&m, &Request::default(), &mut workspace)?;
    all.derivative(&mut point, &mut workspace)?;
    let saved = all.save(&point);
    names(&solved);
    assert!(moves(&all, &point));
    let mut point = all.load(&m, &saved, &Request::default())?;
    all.forget();
    let again = names(&solved).into_iter().collect();
    let derivative = all.derivative(&mut point, &mut EnsembleWorkspace::default())?;
    Ok(([bits(&point.costs), bits(&derivative)].concat(), again))
}

/// Of the members 0, 1, 2 and 3, 4 the third one goes to the second rank.
#[test]
fn motions_that_move_are_solved_once_more_where_they_go_and_no_others() -> Outcome {
    let (serial, _) = moved_motions(arms()?, |_, _| true)?;
    let work = [10, 10, 10, 1, 1];
    let found = run(2, &Faults::default(), |rank| {
        let (_team, all) = on(rank, arms().unwrap());
        // in 2 solves each the third one took 10 iterations: 5 more are less than what is gained
        moved_motions(all, |all, point| all.share_anew(&work, &[point], 2)).unwrap()
    });
    assert!(found.iter().all(|(bits, _)| *bits == serial));
    assert!(found[0].1.is_empty(), "{:?}", found[0].1);
    assert_eq!(found[1].1, ["s2"]);
    // solved once more for each of three points, it would take more than it gains
    let stays = run(2, &Faults::default(), |rank| {
        let (_team, all) = on(rank, arms().unwrap());
        let point = all.evaluate(&start(all.len()), &Request::default(), &mut EnsembleWorkspace::default()).unwrap();
        !all.share_anew(&work, &[&point; 3], 1)
    });
    assert_eq!(stays, [true, true]);
    Ok(())
}

#[test]
fn a_lost_rank_ends_an_optimisation_on_all_ranks() {
    for message in [0, 1, 2, 3, 5, 8, 11, 14, 17, 23, 31, 40] {
        let began = Instant::now();
        let faults = Faults { lost: Some((2, message)), ..Faults::default() };
        let ended = run(4, &faults, |rank| {
            let (_team, all) = on(rank, bars(Mean).unwrap());
            let mut workspace = EnsembleWorkspace::default();
            let mut last: Option<EnsemblePoint> = None;
            for step in 0..6 {
                let m = vec![1e3 + 200.0 * f64::from(step); all.len()];
                let how = Request { near: last.as_ref(), ..Request::default() };
                let mut point = match all.evaluate(&m, &how, &mut workspace) {
                    Ok(point) => point,
                    Err(failed) => return Some(failed),
                };
                if let Err(failed) = all.derivative(&mut point, &mut workspace) {
                    return Some(failed);
                }
                last = Some(point);
            }
            None
        });
        assert!(began.elapsed() < Duration::from_secs(5));
        let is_lost = |failed: &Option<nastic_opt::Failed>| {
            failed.as_ref().is_some_and(|failed| {
                failed.is_fatal() && matches!(failed.downcast_ref(), Some(EnsembleError::Team(_)))
            })
        };
        assert!(ended.iter().all(is_lost), "message {message}: {ended:?}");
    }
}
