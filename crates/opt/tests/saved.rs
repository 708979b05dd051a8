//! The format of what is saved: every field comes back to the bit; no bytes make it panic or allocate what they do not hold.

#![allow(clippy::unwrap_used)] // tests

use nastic_opt::saved::{pack, unpack};
use nastic_opt::{Best, Counts, Failed, RunState, Saved, SavedError, StageEnd, Stall, Stop, Tolerance};

#[test]
fn every_reason_to_stop_is_read_as_it_was_written() {
    let relative_gradient = 0.1 + 0.2;
    let all = [
        Stop::Converged { gradient_norm: 1e-3, first: 3.0, tolerance: Tolerance::Relative(1e-4) },
        Stop::Converged { gradient_norm: 1e-3, first: 3.0, tolerance: Tolerance::Absolute(2e-3) },
        Stop::MaxIterations { iterations: 7, relative_gradient },
        Stop::Cancelled,
        Stop::Infeasible { constraint: "ball".into(), index: 4, violation: 1e-3, penalty: 1e5, gradient: 1e-12 },
        Stop::Outperformed { cost: 0.1, within_reach: 1e-3, best: 1e-4 },
        Stop::Aborted(Failed::because("no memory").fatal()),
        Stop::Stalled(Stall::Flat { cost: 1.0, predicted: -1e-17, relative_gradient }),
        Stop::Stalled(Stall::LineSearch {
            trials: 9,
            failed: 2,
            shortest: 1e-9,
            last: "no decrease".into(),
            relative_gradient,
        }),
        Stop::Stalled(Stall::Stagnation { window: 5, decrease: 1e-9, total: 2.0, relative_gradient }),
        Stop::Stalled(Stall::SecondDerivatives { why: Failed::because("a kink") }),
        Stop::Stalled(Stall::Stage { stage: 2, why: Failed::because("no value there") }),
    ];
    for stop in all {
        let read: Stop = unpack(&pack(&stop)).unwrap();
        assert_eq!((&read, read.to_string()), (&stop, stop.to_string()));
        assert!(!matches!(read, Stop::Aborted(why) if !why.is_fatal()));
    }
}

#[test]
fn numbers_keep_their_bits() {
    let odd =
        [0.0, -0.0, 0.1 + 0.2, f64::MIN_POSITIVE / 3.0, f64::INFINITY, f64::NAN, f64::from_bits(0xfff4_0000_0000_0123)];
    let read: Vec<f64> = unpack(&pack(&odd.to_vec())).unwrap();
    assert!(odd.iter().zip(&read).all(|(a, b)| a.to_bits() == b.to_bits()));
    // length, then bits with the lowest byte first
    assert_eq!(pack(&vec![1.5]), [[1].as_slice(), &1.5f64.to_le_bytes()].concat());
}

#[test]
fn damaged_bytes_are_refused_with_their_place() {
    let run = RunState { method: "lbfgs".into(), ..RunState::default() };
    let bytes = run.to_bytes();
    assert_eq!(RunState::from_bytes(&bytes), Ok(run));
    for end in RunState::KIND.len()..bytes.len() {
        let why = RunState::from_bytes(&bytes[..end]).unwrap_err();
        assert!(matches!(why, SavedError::Damaged { .. }) && why.to_string().contains("end early"), "{end}: {why}");
    }
    let why = RunState::from_bytes(&[bytes.as_slice(), &[0, 0]].concat()).unwrap_err();
    let (at, length) = (bytes.len() - RunState::KIND.len(), bytes.len() - RunState::KIND.len() + 2);
    assert_eq!(why, SavedError::Damaged { at, length, what: "more bytes than expected".into() });
    // a result is no run, and neither are bytes of the version before
    let expected = SavedError::Kind { expected: RunState::KIND };
    assert_eq!(RunState::from_bytes(b"nastic-run-2 and more"), Err(expected));
    assert!(matches!(Best::<Vec<u8>>::from_bytes(&bytes), Err(SavedError::Kind { .. })));
}

/// A length that the bytes do not hold costs no memory: 2^60 numbers would end the process.
#[test]
fn a_length_beyond_the_bytes_is_refused() {
    let huge = pack(&(1u64 << 60));
    assert!(unpack::<Vec<f64>>(&huge).is_err());
    assert!(unpack::<Vec<Vec<u8>>>(&huge).is_err());
    assert!(unpack::<String>(&huge).is_err());
    assert!(unpack::<Vec<StageEnd>>(&huge).is_err());
    assert!(unpack::<Counts>(&[0xff; 40]).is_err(), "a count beyond 64 bits");
}
