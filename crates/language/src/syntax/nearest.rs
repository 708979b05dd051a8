//! The known name that a misspelt one stands for.

/// ": did you mean "mu1"? (one of: mu1, mu2, mu3)"; " (one of: ...)" where no name is near; or nothing.
pub(crate) fn clause(wrong: &str, known: &[&str]) -> String {
    match nearest(wrong, known) {
        Some(best) => format!(": did you mean \"{best}\"? (one of: {})", known.join(", ")),
        None if known.is_empty() => String::new(),
        None => format!(" (one of: {})", known.join(", ")),
    }
}

/// The known name with the fewest single-letter changes of those that may have been meant; the first of several.
#[must_use]
pub fn nearest<'a>(wrong: &str, known: &[&'a str]) -> Option<&'a str> {
    known.iter().filter(|name| is_near(wrong, name)).min_by_key(|name| distance(wrong, name)).copied()
}

/// Whether a name may have been meant. Names that share little say nothing, and send the reader the wrong way: "us" is not "um".
fn is_near(wrong: &str, known: &str) -> bool {
    let longest = letters(wrong).len().max(letters(known).len());
    let few_changes = 3 * distance(wrong, known) <= 2 * longest;
    few_changes || wrong.eq_ignore_ascii_case(known) || abbreviates(wrong, known) || begins(wrong, known)
}

/// "holzapfel" and "hgo" of "holzapfel_gasser_ogden".
fn abbreviates(short: &str, long: &str) -> bool {
    let initials: String = long.split('_').filter_map(|word| word.chars().next()).collect();
    let is_initials = initials.len() > 1 && initials.eq_ignore_ascii_case(short);
    is_initials || begins(long, short)
}

/// Whether a text begins with another one that is long enough to mean something.
fn begins(text: &str, with: &str) -> bool {
    with.len() > 2 && text.get(..with.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(with))
}

/// Optimal string alignment: insert, delete, replace, swap neighbours; a mere change of case costs nothing more than
/// half a replacement. Counted in halves.
fn distance(a: &str, b: &str) -> usize {
    let (a, b) = (letters(a), letters(b));
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

/// The letters that are compared: nobody mistypes a hundred, and the cost is quadratic.
fn letters(text: &str) -> Vec<char> {
    text.chars().take(100).collect()
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
        assert_eq!(nearest(&"x".repeat(100_000), &["ab", "abc"]), None);
    }

    #[test]
    fn names_that_share_little_are_not_suggested() {
        for (wrong, known) in [("us", "um"), ("hgo", "yeoh"), ("tension", "pull"), ("mu0", "name"), ("st", "start")] {
            assert_eq!(nearest(wrong, &[known]), None, "{wrong}");
        }
        let laws = ["yeoh", "neo_hooke", "neo_hooke_isochoric", "holzapfel_gasser_ogden"];
        for (wrong, right) in [("hgo", laws[3]), ("Holzapfel", laws[3]), ("NH", laws[1]), ("neo", laws[1])] {
            assert_eq!(nearest(wrong, &laws), Some(right), "{wrong}");
        }
        for (wrong, right) in [("X", "x"), ("maximum", "max"), ("mu", "mu1")] {
            assert_eq!(nearest(wrong, &[right]), Some(right), "{wrong}");
        }
    }
}
