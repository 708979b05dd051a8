//! Checkpoints that are damaged, of another program or no checkpoints at all are refused, each with its reason.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::result::CheckpointError;
use nastic_run::run::{Exit, OnTrial, Options, Outcome, RunError, resume};
use std::sync::atomic::{AtomicUsize, Ordering};

const SHORT: [&str; 3] = ["optimizer/max_iterations=7", "optimizer/tolerance=1e-9", "output/checkpoint=3"];

/// Optimises until a few trials were made.
fn interrupt(place: &CaseDirectory) {
    let mut options = place.options(&SHORT);
    let (heard, cancel) = (AtomicUsize::new(0), options.cancel.clone());
    options.on_trial = OnTrial::call(move |_| {
        cancel.fetch_or(heard.fetch_add(1, Ordering::Relaxed) == 4, Ordering::Relaxed);
    });
    let outcome = place.run_with(Command::Optimize, BAR, &Console::silent(), &options).unwrap();
    assert_eq!(outcome.exit, Exit::NotConverged);
}

fn go_on(place: &CaseDirectory) -> Result<Outcome, RunError> {
    resume(&Catalogue::standard(), &place.path("out"), &place.options(&[]), &Console::silent())
}

fn refused(place: &CaseDirectory) -> CheckpointError {
    match go_on(place) {
        Err(error @ RunError::Checkpoint(_)) if error.exit() != Exit::BadInput => panic!("{error}"),
        Err(RunError::Checkpoint(why)) => why,
        other => panic!("not refused: {other:?}"),
    }
}

#[test]
fn a_checkpoint_that_cannot_be_read_is_not_replaced_unasked() {
    let place = CaseDirectory::new();
    place.run(Command::Optimize, BAR, &SHORT).unwrap();
    let file = place.path("out/checkpoint.bin");
    let whole = std::fs::read(&file).unwrap();
    let flipped = |at: usize| {
        let mut bytes = whole.clone();
        bytes[at] ^= 4;
        bytes
    };
    let other = enveloped(b"nastic-optimisation-9, and what such a one held");
    // a checkpoint of the version before, which had other bytes
    let mut old = whole.clone();
    old[17] = 1;
    let of_before = "is a checkpoint of format 1, this program reads format 2: the version of nastic that wrote it can go on with it";
    let cases = [
        (flipped(17), "is a checkpoint of format 6, this program reads format 2"),
        (flipped(whole.len() - 1), "is damaged: the checksum of its content is not the one"),
        (whole[..whole.len() / 2].to_vec(), "is damaged: it has "),
        (other, "does not fit: not a saved run of this version"),
        (old, of_before),
    ];
    for (bytes, reason) in cases {
        std::fs::write(&file, &bytes).unwrap();
        let error = place.run(Command::Optimize, BAR, &SHORT).unwrap_err();
        let message = error.to_string();
        assert!(matches!(error, RunError::UnreadableCheckpoint(_)) && error.exit() == Exit::BadInput, "{message}");
        assert!(message.contains(reason) && message.contains("begin anew with --restart"), "{message}");
        assert!(std::fs::read(&file).unwrap() == bytes, "{message}: replaced");
    }
    let options = Options { restart: true, ..place.options(&SHORT) };
    place.run_with(Command::Optimize, BAR, &Console::silent(), &options).unwrap();
    // The new one can be read, and has ended.
    place.run(Command::Optimize, BAR, &SHORT).unwrap();
    // What the system refuses to read.
    std::fs::remove_file(&file).unwrap();
    std::fs::create_dir(&file).unwrap();
    let error = place.run(Command::Optimize, BAR, &SHORT).unwrap_err();
    assert!(matches!(error, RunError::UnreadableCheckpoint(CheckpointError::Read { .. })), "{error}");
}

#[test]
fn damaged_and_foreign_checkpoints_are_refused() {
    let place = CaseDirectory::new();
    interrupt(&place);
    let file = place.path("out/checkpoint.bin");
    let whole = std::fs::read(&file).unwrap();
    for length in (0..whole.len()).step_by(97) {
        std::fs::write(&file, &whole[..length]).unwrap();
        let why = refused(&place);
        assert!(matches!(why, CheckpointError::Length { .. }), "{length} bytes: {why}");
    }
    for at in (0..whole.len()).step_by(61) {
        let mut bytes = whole.clone();
        bytes[at] ^= 4;
        std::fs::write(&file, &bytes).unwrap();
        let why = refused(&place);
        let expected = match at {
            0..17 => matches!(why, CheckpointError::Foreign { .. }),
            17..25 => matches!(why, CheckpointError::Version { .. }),
            25..33 => matches!(why, CheckpointError::Length { .. }),
            _ => matches!(why, CheckpointError::Checksum { .. }),
        };
        assert!(expected, "byte {at}: {why}");
    }
    std::fs::write(&file, [whole.as_slice(), b"more"].concat()).unwrap();
    assert!(matches!(refused(&place), CheckpointError::Length { .. }));
    std::fs::write(&file, "{ \"nastic\": 1 }").unwrap();
    assert!(matches!(refused(&place), CheckpointError::Foreign { .. }));
    // Whole, but not one that this program wrote for this case.
    let (old, content) = (env!("CARGO_PKG_VERSION").as_bytes(), whole[41..].to_vec());
    let kind = content.iter().position(|byte| *byte < b' ').unwrap();
    let at = content.windows(old.len()).position(|part| part == old).unwrap();
    let mut other = content.clone();
    other[at] = b'9';
    std::fs::write(&file, enveloped(&other)).unwrap();
    assert!(matches!(refused(&place), CheckpointError::Program { found, .. } if found.starts_with("9.")));
    // a content that ends early, or whose lengths lie, with a checksum that holds
    for end in (0..content.len()).step_by(131) {
        std::fs::write(&file, enveloped(&content[..end])).unwrap();
        let why = refused(&place);
        assert!(matches!(why, CheckpointError::Content { .. }), "{end} bytes of content: {why}");
    }
    for at in (kind..content.len()).step_by(173) {
        let mut bytes = content.clone();
        bytes[at..content.len().min(at + 10)].fill(0xff);
        std::fs::write(&file, enveloped(&bytes)).unwrap();
        let _ = go_on(&place).map_err(|why| why.to_string());
    }
    std::fs::write(&file, enveloped(&content)).unwrap();
    assert_eq!(std::fs::read(&file).unwrap(), whole);
    go_on(&place).unwrap();
}

/// Content with the header of docs/results.md.
fn enveloped(content: &[u8]) -> Vec<u8> {
    let length = (content.len() as u64).to_le_bytes();
    let hashed = length.iter().chain(content);
    let hash =
        hashed.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3));
    [b"nastic-checkpoint".as_slice(), &2u64.to_le_bytes(), &length, &hash.to_le_bytes(), content].concat()
}
