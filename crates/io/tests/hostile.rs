//! Files that lie: every one is a typed error that says where, none a panic or an allocation for a claimed count.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // clippy.toml frees test functions, not their helpers

use std::path::PathBuf;

use nastic_io::{ReadError, parse_gmsh, parse_vtu, read_gmsh, read_mesh, write_vtu};
use nastic_mesh::{CellKind, Snapshot, box_mesh};

fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(data(name)).unwrap()
}

fn text(name: &str) -> String {
    String::from_utf8(bytes(name)).unwrap()
}

/// The message of a refused file.
fn refused(bytes: &[u8]) -> String {
    parse_gmsh("bad.msh", bytes, 1.0).expect_err("taken").to_string()
}

/// Replaces the first occurrence, which must be there.
fn with(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old:?}");
    text.replacen(old, new, 1)
}

#[test]
fn missing_files_and_unknown_endings_are_named() {
    let error = read_gmsh("no/such/mesh.msh").unwrap_err();
    assert!(matches!(error, ReadError::Open { .. }));
    assert!(error.to_string().contains("no/such/mesh.msh"), "{error}");
    let error = read_mesh("mesh.stl", 1.0).unwrap_err().to_string();
    assert!(error.contains("mesh.stl: this is a surface") && error.contains("-o mesh.msh"), "{error}");
    let error = read_mesh("mesh.xyz", 1.0).unwrap_err().to_string();
    assert!(error.contains("mesh.xyz") && error.contains(".msh") && error.contains(".vtu"), "{error}");
    assert!(matches!(read_gmsh(env!("CARGO_MANIFEST_DIR")), Err(ReadError::Open { .. })));
}

#[test]
fn other_formats_are_named() {
    for (file, version) in [("old.40a.msh", "format 4 "), ("old.1a.msh", "$MeshFormat")] {
        let message = refused(&bytes(file));
        assert!(message.contains(version) && message.contains("2.2"), "{message}");
    }
    let message = refused(&bytes("old.40a.msh"));
    assert!(message.starts_with("bad.msh, line 2, in $MeshFormat: ") && message.contains("msh41"), "{message}");
    let message = refused(b"solid cube\n");
    assert!(message.contains("line 1") && message.contains("`solid cube`"), "{message}");
    assert!(refused(b"").contains("the file ends without $MeshFormat"));
    assert!(refused(&[0xff; 100]).contains("not text"));
    assert!(refused(b"$MeshFormat\n4.1 0 4\n$EndMeshFormat\n").contains("data size 4"));
    assert!(refused(b"$MeshFormat\n4.1 7 8\n$EndMeshFormat\n").contains("file type 7"));
    assert!(refused(b"$MeshFormat\n4.1 1 8\n\x02\0\0\0\n$EndMeshFormat\n").contains("byte order"));
}

#[test]
fn foreign_cells_are_named() {
    let expect = [
        ("prism.41a.msh", "the 6-node prism (Gmsh element type 6)", ", line "),
        ("prism.22b.msh", "the 6-node prism", ", byte "),
        ("cubic.41b.msh", "third-order", ", byte "),
    ];
    for (file, name, place) in expect {
        let error = parse_gmsh("bad.msh", &bytes(file), 1.0).unwrap_err();
        assert!(matches!(error, ReadError::Unsupported { .. }));
        let message = error.to_string();
        assert!(message.contains(name) && message.contains(place) && message.contains("second order"), "{message}");
    }
    let pyramid = with(&text("hex8.41a.msh"), "3 1 5 2\n", "3 1 7 2\n");
    assert!(refused(pyramid.as_bytes()).contains("the 5-node pyramid"));
    let nonsense = with(&text("hex8.41a.msh"), "3 1 5 2\n", "3 1 4711 2\n");
    assert!(refused(nonsense.as_bytes()).contains("no Gmsh element type 4711"));
}

#[test]
fn lying_counts_are_refused_before_anything_is_allocated() {
    let v4 = text("hex8.41a.msh");
    let v2 = text("hex8.22a.msh");
    let huge = u64::MAX.to_string();
    let nodes4 = with(&v4, "$Nodes\n", "$Nodes\n#");
    let head = nodes4.split('#').nth(1).unwrap().lines().next().unwrap().to_owned();
    for claimed in ["1000000000000", &huge, "100000"] {
        let message =
            refused(with(&v4, &head, &format!("{} {claimed} 1 12", head.split(' ').next().unwrap())).as_bytes());
        assert!(message.contains("in $Nodes") && message.contains(claimed), "{message}");
        assert!(message.contains("bytes are left"), "{message}");
        let message = refused(with(&v2, "$Nodes\n12\n", &format!("$Nodes\n{claimed}\n")).as_bytes());
        assert!(message.contains("claims") && message.contains(claimed) && message.contains("$Nodes"), "{message}");
    }
    // One too many, one too few: the file is long enough, the section is not.
    for (claimed, says) in [("13", "`$EndNodes`"), ("11", "expected $EndNodes")] {
        let message = refused(with(&v2, "$Nodes\n12\n", &format!("$Nodes\n{claimed}\n")).as_bytes());
        assert!(message.contains(says) && message.contains("line "), "{message}");
    }
    let message = refused(with(&v2, "$Nodes\n12\n", "$Nodes\n-1\n").as_bytes());
    assert!(message.contains("`-1`"), "{message}");
    // Binary: the counts of blocks, nodes, elements and entities all overwritten in turn.
    let binary = bytes("hex8.41b.msh");
    for section in ["$Entities\n", "$Nodes\n", "$Elements\n"] {
        let start = binary.windows(section.len()).position(|w| w == section.as_bytes()).unwrap() + section.len();
        for word in 0..2 {
            let mut bad = binary.clone();
            bad[start + 8 * word..][..8].copy_from_slice(&(u64::MAX / 3).to_le_bytes());
            let message = refused(&bad);
            assert!(message.contains("byte ") && message.contains("bytes are left"), "{message}");
        }
    }
}

#[test]
fn bad_numbers_are_named_with_their_place() {
    let v4 = text("hex8.41a.msh");
    for (bad, says) in [("nan", "NaN"), ("inf", "inf"), ("1e999", "inf")] {
        let message = refused(with(&v4, "\n2 0.1 0\n", &format!("\n2 {bad} 0\n")).as_bytes());
        assert!(message.contains("y of node 2 is") && message.contains(says) && message.contains("line "), "{message}");
    }
    let message = refused(with(&v4, "\n2 0.1 0\n", "\n2 O.1 0\n").as_bytes());
    assert!(message.contains("`O.1`"), "{message}");
    let mut binary = bytes("hex8.22b.msh");
    let at = binary.windows(7).position(|w| w == b"$Nodes\n").unwrap();
    let at = at + b"$Nodes\n12\n".len() + 4;
    binary[at..at + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    let message = refused(&binary);
    assert!(message.contains("x of node 1 is NaN") && message.contains("byte "), "{message}");
    // Scaling may overflow what the file holds.
    let error = parse_gmsh("big.msh", with(&v4, "\n2 0.1 0\n", "\n2 1e300 0\n").as_bytes(), 1e10).unwrap_err();
    assert!(error.to_string().contains("y of node 2"), "{error}");
}

#[test]
fn indices_out_of_range_are_named() {
    let v2 = text("tri3.22a.msh");
    let line = v2.lines().find(|line| line.contains(" 2 2 1 1 ")).unwrap();
    let mut words: Vec<&str> = line.split(' ').collect();
    let last = words.len() - 1;
    for bad in ["99", "0", "4000000000", "-3", "99999999999999999999"] {
        words[last] = bad;
        let message = refused(with(&v2, line, &words.join(" ")).as_bytes());
        assert!(message.contains("in $Elements") && message.contains("line "), "{message}");
        if bad == "99" {
            assert!(message.contains("names node 99, which the file does not define"), "{message}");
        }
    }
    // The same node twice in a cell, twice in the list.
    words[last] = words[last - 1];
    let message = refused(with(&v2, line, &words.join(" ")).as_bytes());
    assert!(message.contains("bad.msh") && message.contains("twice"), "{message}");
    let message = refused(with(&v2, "\n2 2 0.1 0\n", "\n1 2 0.1 0\n").as_bytes());
    assert!(message.contains("node 1 is defined twice"), "{message}");
    // An entity that $Entities does not list (meshio leaves them out): its elements lie in no group, which is noted.
    let v4 = with(&text("hex8.41a.msh"), "2 25 3 1\n", "2 77 3 1\n");
    let mesh = parse_gmsh("x.msh", v4.as_bytes(), 1.0).unwrap();
    assert!(mesh.notes().join("; ").contains("group \"clamp\" (dimension 2) has no elements"), "{:?}", mesh.notes());
}

#[test]
fn sparse_tags_are_taken_whatever_their_size() {
    let v4 = text("tri3.41a.msh");
    let plain = parse_gmsh("x", v4.as_bytes(), 1.0).unwrap();
    let far = 9_000_000_000_000_000_000_u64;
    let (head, rest) = v4.split_once("$Nodes\n").unwrap();
    let (nodes, elements) = rest.split_once("$Elements\n").unwrap();
    // A line of one word among the nodes is a tag; in an element all words but the first are.
    let renamed = |word: &str| (far + 1_000_003 * word.parse::<u64>().unwrap()).to_string();
    let mut lines = Vec::new();
    for line in nodes.lines() {
        lines.push(if line.parse::<u64>().is_ok() { renamed(line) } else { line.to_owned() });
    }
    lines.push("$Elements".to_owned());
    let mut left = 0;
    for (at, line) in elements.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        if left > 0 {
            left -= 1;
            let nodes: Vec<String> = words[1..].iter().map(|word| renamed(word)).collect();
            lines.push(format!("{} {}", words[0], nodes.join(" ")));
            continue;
        }
        if at > 0 && words.len() == 4 {
            left = words[3].parse().unwrap();
        }
        lines.push(line.to_owned());
    }
    let sparse = format!("{head}$Nodes\n{}\n", lines.join("\n"));
    let sparse = parse_gmsh("x", sparse.as_bytes(), 1.0).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((sparse.points(), sparse.blocks()), (plain.points(), plain.blocks()));
}

#[test]
fn bodies_that_are_none_are_refused() {
    let flat = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 1 0\n3 2 2 0\n$EndNodes\n\
                $Elements\n1\n41 2 2 1 1 1 2 3\n$EndElements\n";
    let message = refused(flat.as_bytes());
    assert!(message.contains("bad.msh: tri3 41 has zero volume"), "{message}");
    let lines = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n2 1 0 0\n$EndNodes\n$Elements\n1\n1 1 2 1 1 1 2\n$EndElements\n";
    assert!(refused(lines.as_bytes()).contains("no volume cells and no plane cells"));
    assert!(refused(lines.split("$Elements").next().unwrap().as_bytes()).contains("ends without $Elements"));
}

/// A small generator of numbers: the same mutations in every run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % sides
    }
}

#[test]
fn every_truncation_is_refused() {
    for file in ["hex8.22a.msh", "hex8.22b.msh", "tet10.41a.msh", "hex27.41b.msh", "partitioned.41b.msh"] {
        let whole = bytes(file);
        let end = whole.trim_ascii_end().len();
        for length in 0..end {
            let error = parse_gmsh("cut.msh", &whole[..length], 1.0);
            assert!(error.is_err(), "{file} cut to {length} bytes of {end} is taken");
        }
    }
}

#[test]
fn mutated_files_never_panic() {
    let mut dice = Dice(1);
    let files = ["hex8.22a.msh", "tri6.22b.msh", "parametric.41a.msh", "quad9.41b.msh", "partitioned.41b.msh"];
    let (mut taken, mut total) = (0, 0);
    for file in files {
        let whole = bytes(file);
        for _ in 0..400 {
            let mut bad = whole.clone();
            for _ in 0..=dice.roll(3) {
                let at = dice.roll(bad.len());
                match dice.roll(5) {
                    0 => bad[at] = dice.roll(256) as u8,
                    1 => bad[at] ^= 1 << dice.roll(8),
                    2 => drop(bad.remove(at)),
                    3 => bad.insert(at, b"0123456789 -.e\n"[dice.roll(15)]),
                    _ => (at..(at + 8).min(bad.len())).for_each(|k| bad[k] = 0xff),
                }
            }
            total += 1;
            taken += usize::from(parse_gmsh("bad.msh", &bad, 1.0).is_ok());
        }
    }
    // Some mutations only move a node.
    assert!(taken > 0 && taken < total / 2, "{taken} of {total} taken");
}

#[test]
fn mutated_and_truncated_vtu_never_panic() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("good.vtu");
    let mesh = box_mesh([1.0, 1.0, 1.0], [1, 1, 1], CellKind::Tet10).unwrap();
    write_vtu(&path, &Snapshot::new(mesh)).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for length in 0..whole.trim_ascii_end().len() {
        assert!(parse_vtu("cut.vtu", &whole[..length], 1.0).is_err(), "cut to {length}");
    }
    let mut dice = Dice(2);
    for _ in 0..1000 {
        let mut bad = whole.clone();
        for _ in 0..=dice.roll(3) {
            let at = dice.roll(bad.len());
            match dice.roll(3) {
                0 => bad[at] = b"<>/\"'=_&; A0"[dice.roll(12)],
                1 => bad[at] ^= 1 << dice.roll(8),
                _ => drop(bad.remove(at)),
            }
        }
        let _ = parse_vtu("bad.vtu", &bad, 1.0);
    }
    let text = String::from_utf8(whole).unwrap();
    for count in ["99", "18446744073709551615", "1e3", "-1"] {
        let points = with(&text, "NumberOfPoints=\"27\"", &format!("NumberOfPoints=\"{count}\""));
        let message = parse_vtu("bad.vtu", points.as_bytes(), 1.0).unwrap_err().to_string();
        assert!(message.starts_with("bad.vtu, line ") && message.contains("; "), "{message}");
    }
    let deep = "<a>".repeat(100_000);
    assert!(parse_vtu("deep.vtu", deep.as_bytes(), 1.0).unwrap_err().to_string().contains("deep"));
}

/// A file of 4.1 or 2.2 in big-endian bytes: the tests' own little writer.
#[test]
fn big_endian_files_are_read() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut v2 = b"$MeshFormat\n2.2 1 8\n".to_vec();
    v2.extend(1_i32.to_be_bytes());
    v2.extend(b"\n$EndMeshFormat\n$Nodes\n4\n");
    for (at, point) in (1_i32..).zip(&points) {
        v2.extend(at.to_be_bytes());
        v2.extend(point.iter().flat_map(|x: &f64| x.to_be_bytes()));
    }
    v2.extend(b"\n$EndNodes\n$Elements\n1\n");
    v2.extend([4, 1, 2, 1, 7, 1, 1, 2, 3, 4].into_iter().flat_map(i32::to_be_bytes));
    v2.extend(b"\n$EndElements\n");

    let int = |out: &mut Vec<u8>, values: &[i32]| out.extend(values.iter().flat_map(|v| v.to_be_bytes()));
    let size = |out: &mut Vec<u8>, values: &[u64]| out.extend(values.iter().flat_map(|v| v.to_be_bytes()));
    let real = |out: &mut Vec<u8>, values: &[f64]| out.extend(values.iter().flat_map(|v| v.to_be_bytes()));
    let mut v4 = b"$MeshFormat\n4.1 1 8\n".to_vec();
    int(&mut v4, &[1]);
    v4.extend(b"\n$EndMeshFormat\n$Entities\n");
    size(&mut v4, &[0, 0, 0, 1]);
    int(&mut v4, &[1]);
    real(&mut v4, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    size(&mut v4, &[1]);
    int(&mut v4, &[7]);
    size(&mut v4, &[0]);
    v4.extend(b"\n$EndEntities\n$Nodes\n");
    size(&mut v4, &[1, 4, 1, 4]);
    int(&mut v4, &[3, 1, 0]);
    size(&mut v4, &[4, 1, 2, 3, 4]);
    real(&mut v4, points.as_flattened());
    v4.extend(b"\n$EndNodes\n$Elements\n");
    size(&mut v4, &[1, 1, 1, 1]);
    int(&mut v4, &[3, 1, 4]);
    size(&mut v4, &[1, 1, 1, 2, 3, 4]);
    v4.extend(b"\n$EndElements\n");
    for file in [v2, v4] {
        let mesh = parse_gmsh("big.msh", &file, 1.0).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((mesh.points(), mesh.cells()), (&points[..], 1));
        assert_eq!(mesh.region("7").unwrap(), [0]);
    }
}
