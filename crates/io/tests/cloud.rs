//! Point clouds: each format as written here and as others write it, and what is refused.

use nastic_io::{PointCloud, ReadError, read_cloud, write_cloud};
use std::path::PathBuf;

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// A directory with files of these bytes.
fn file(name: &str, content: &[u8]) -> Result<(tempfile::TempDir, PathBuf), std::io::Error> {
    let directory = tempfile::tempdir()?;
    let path = directory.path().join(name);
    std::fs::write(&path, content)?;
    Ok((directory, path))
}

fn read(name: &str, content: &[u8]) -> Result<Vec<[f64; 3]>, Box<dyn std::error::Error>> {
    let (_directory, path) = file(name, content)?;
    Ok(read_cloud(path, 1.0)?)
}

#[test]
fn what_is_written_is_read_to_the_bit() -> Outcome {
    let points: Vec<[f64; 3]> =
        (0..7).map(|k| [f64::from(k).sqrt(), -f64::from(k) / 3.0, 1e-9 * f64::from(k)]).collect();
    let reference = points.iter().map(|x| x.map(|x| x + 1.0)).collect();
    let cloud = PointCloud { nodes: (10..17).collect(), reference, points };
    let directory = tempfile::tempdir()?;
    for name in ["a.csv", "a.npy", "A.PLY"] {
        let path = directory.path().join(name);
        write_cloud(&path, &cloud)?;
        assert_eq!(read_cloud(&path, 1.0)?, cloud.points, "{name}");
        let scaled = read_cloud(&path, 1e-3)?;
        assert!(scaled.iter().flatten().zip(cloud.points.iter().flatten()).all(|(a, b)| *a == 1e-3 * b), "{name}");
    }
    let text = std::fs::read_to_string(directory.path().join("a.csv"))?;
    assert!(text.starts_with("node,X,Y,Z,x,y,z\n10,1,1,1,0,-0,0\n11,2,"), "{text}");
    assert_eq!(std::fs::read(directory.path().join("a.npy"))?.len(), 128 + 8 * 21);
    let wrong = write_cloud(directory.path().join("a.xyz"), &cloud).err().map(|error| error.to_string());
    assert!(wrong.is_some_and(|words| words.contains(".csv, .npy or .ply")));
    Ok(())
}

#[test]
fn tables_of_others_are_read() -> Outcome {
    let wanted = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
    for text in [
        "1,2,3\n4,5,6\n",
        "# a scan\n1 2 3\n\n4\t5 6 # last\n",
        "y;x;quality;z\n2;1;0.9;3\r\n5;4;0.8;6\r\n",
        "\u{feff}\"X\",\"Y\",\"Z\"\n1,2,3\n4,5,6",
        "1,2,3,255\n4,5,6,0\n",
        "\"Points:0\",\"Points:1\",\"Points:2\",\"u\"\n1,2,3,0\n4,5,6,0\n",
        "x [mm];y [mm];z [mm]\n1,0;2,0;3,0\n4,0;5,0;6,0\n",
        "1,0;2,0;3,0\n4,0;5;6,0\n",
        "X (mm)\tY (mm)\tZ (mm)\n1,0\t2,0\t3,0\n4,0\t5,0\t6,0\n",
        "1,\t2,\t3\n4,\t5,\t6\n",
    ] {
        assert_eq!(read("a.csv", text.as_bytes())?, wanted, "{text}");
    }
    assert_eq!(read("a.csv", b"x,y\n1,2\n")?, [[1.0, 2.0, 0.0]]);
    assert_eq!(read("a.csv", b"1 2\n3 4\n")?, [[1.0, 2.0, 0.0], [3.0, 4.0, 0.0]]);
    for (text, words) in [
        ("a,b\n1,2\n", "has no x and y"),
        ("1,2,3\n4,five,6\n", "line 2"),
        ("1,2,3\n4,5\n", "column 3 is \"\""),
        ("x,y,z\n", "there are none"),
        ("1,2,nan\n", "point 0"),
    ] {
        let error = read("a.csv", text.as_bytes()).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(words), "{text}: {error}");
    }
    Ok(())
}

/// As NumPy writes an array of these numbers.
fn npy(dict: &str, numbers: &[u8]) -> Vec<u8> {
    let mut out = b"\x93NUMPY\x01\x00".to_vec();
    out.extend((dict.len() as u16 + 1).to_le_bytes());
    out.extend(dict.as_bytes());
    out.push(b'\n');
    out.extend(numbers);
    out
}

#[test]
fn arrays_of_numpy_are_read_in_either_order_and_precision() -> Outcome {
    let dict = |kind: &str, order: &str, shape: &str| {
        format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}")
    };
    let bytes = |numbers: &[f32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>();
    let rows = npy(&dict("<f4", "False", "(2, 3)"), &bytes(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let columns = npy(&dict("<f4", "True", "(2, 3)"), &bytes(&[1.0, 4.0, 2.0, 5.0, 3.0, 6.0]));
    let wanted = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
    assert_eq!(read("a.npy", &rows)?, wanted);
    assert_eq!(read("a.npy", &columns)?, wanted);
    let big: Vec<u8> = [1.5f64, -2.5].iter().flat_map(|x| x.to_be_bytes()).collect();
    assert_eq!(read("a.npy", &npy(&dict(">f8", "False", "(1, 2)"), &big))?, [[1.5, -2.5, 0.0]]);
    let whole: Vec<u8> = [1i64, 2, 3, 4, 5, 6].iter().flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(read("a.npy", &npy(&dict("<i8", "False", "(2, 3)"), &whole))?, wanted);
    assert_eq!(read("a.npy", &npy(&dict("|u1", "True", "(2, 3)"), &[1, 4, 2, 5, 3, 6]))?, wanted);
    assert_eq!(read("a.npy", &npy(&dict(">i2", "False", "(1, 2)"), &[0, 7, 255, 255]))?, [[7.0, -1.0, 0.0]]);
    for (content, words) in [
        (npy(&dict("<c16", "False", "(1, 3)"), &[0; 48]), "an array of \"<c16\""),
        (npy(&dict("<f8", "False", "(6,)"), &[0; 48]), "(n, 2) or (n, 3)"),
        (npy(&dict("<f8", "False", "(99999999999, 3)"), &[0; 48]), "of which 6 are there"),
        (rows[..8].to_vec(), "the file ends in it"),
        (rows[..30].to_vec(), "the file ends in it"),
        (b"NUMPY".to_vec(), "does not begin with"),
    ] {
        let error = read("a.npy", &content).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(words), "{words}: {error}");
    }
    Ok(())
}

#[test]
fn vertices_of_ply_are_read_among_other_properties() -> Outcome {
    let head = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment by a scanner\nelement vertex 2\nproperty float x\nproperty uchar red\nproperty float y\n\
             property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let wanted = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
    assert_eq!(read("a.ply", (head("ascii") + "1 255 2 3\n4 0 5 6\n3 0 1 1\n").as_bytes())?, wanted);
    let mut binary = head("binary_big_endian").into_bytes();
    for [x, y, z] in [[1.0f32, 2.0, 3.0], [4.0, 5.0, 6.0]] {
        binary.extend(x.to_be_bytes());
        binary.push(7);
        binary.extend(y.to_be_bytes());
        binary.extend(z.to_be_bytes());
    }
    assert_eq!(read("a.ply", &binary)?, wanted);
    for (content, words) in [
        (binary[..binary.len() - 1].to_vec(), "of which 1 are there"),
        ((head("ascii") + "1 255 2 3\n").into_bytes(), "of which 1 are there"),
        ((head("ascii") + "1 255 2 3\n4 0 5\n").into_bytes(), "line 13"),
        (head("ascii").replace(" x", " u").into_bytes(), "no x, y and z"),
        (head("ascii").replace("vertex 2", "vertex many").into_bytes(), "\"many\" vertices"),
        (head("binary_pdp_endian").into_bytes(), "binary_pdp_endian"),
        (b"solid a\n".to_vec(), "does not begin with \"ply\""),
        (b"ply\nformat ascii 1.0\n".to_vec(), "the file ends in it"),
    ] {
        let error = read("a.ply", &content).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(words), "{words}: {error}");
    }
    Ok(())
}

#[test]
fn other_files_and_scales_are_refused_by_name() -> Outcome {
    let (_directory, path) = file("a.csv", b"1,2,3\n")?;
    assert!(matches!(read_cloud(&path, 0.0), Err(ReadError::Scale { .. })));
    assert!(matches!(read_cloud(path.with_extension("xyz"), 1.0), Err(ReadError::CloudExtension { .. })));
    assert!(matches!(read_cloud(path.with_file_name("b.csv"), 1.0), Err(ReadError::Open { .. })));
    Ok(())
}
