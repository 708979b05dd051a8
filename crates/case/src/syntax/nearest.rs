//! The nearest known name to a misspelt one.

/// ": did you mean "mu1"? (mu1, mu2, mu3)", or what there is, or nothing.
pub(crate) fn clause(wrong: &str, known: &[&str]) -> String {
    match nearest(wrong, known) {
        Some(best) => format!(": did you mean \"{best}\"? (one of: {})", known.join(", ")),
        None => String::new(),
    }
}

/// The known name with the fewest single-letter changes; the first of several.
pub(crate) fn nearest<'a>(wrong: &str, known: &[&'a str]) -> Option<&'a str> {
    known.iter().min_by_key(|name| distance(wrong, name)).copied()
}

/// Optimal string alignment: insert, delete, replace, swap neighbours; a mere change of case costs nothing more than
/// half a replacement. Counted in halves.
fn distance(a: &str, b: &str) -> usize {
    // Nobody mistypes a hundred letters, and the cost is quadratic.
    let a: Vec<char> = a.chars().take(100).collect();
    let b: Vec<char> = b.chars().take(100).collect();
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).map(|j| 2 * j).collect()];
    for i in 1..=a.len() {
        let mut row = vec![2 * i];
        for j in 1..=b.len() {
            let replace = rows[i - 1][j - 1] + replacement(a[i - 1], b[j - 1]);
            let mut best = replace.min(rows[i - 1][j] + 2).min(row[j - 1] + 2);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 2);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

fn replacement(a: char, b: char) -> usize {
    match (a == b, a.eq_ignore_ascii_case(&b)) {
        (true, _) => 0,
        (_, true) => 1,
        _ => 2,
    }
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn the_nearest_name_is_the_one_with_fewest_changes() {
        let keys = ["lower", "upper", "norm", "max_norm", "start"];
        for (wrong, right) in
            [("lowr", "lower"), ("uper", "upper"), ("norrm", "norm"), ("strat", "start"), ("NORM", "norm")]
        {
            assert_eq!(nearest(wrong, &keys), Some(right), "{wrong}");
        }
        assert_eq!(nearest("x", &[]), None);
        assert_eq!(nearest(&"x".repeat(100_000), &["ab", "abc"]), Some("ab"));
    }
}
