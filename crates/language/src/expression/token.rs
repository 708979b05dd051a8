//! Text to tokens.

use crate::syntax::quoted;
use std::fmt;

#[derive(Clone, PartialEq, Debug)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    /// An operator, parenthesis or comma.
    Sign(&'static str),
    End,
}

/// A token and its column, counted in characters from 1.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Placed {
    pub(super) token: Token,
    pub(super) column: usize,
}

/// What went wrong and in which column.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct CaseProblem {
    pub(super) column: usize,
    pub(super) message: String,
}

/// Longest first, so that "<=" is not read as "<".
const SIGNS: [&str; 14] = ["<=", ">=", "==", "!=", "<", ">", "+", "-", "*", "/", "^", "(", ")", ","];

/// All tokens, closed by [`Token::End`].
pub(super) fn tokens(text: &str) -> Result<Vec<Placed>, CaseProblem> {
    let chars: Vec<char> = text.chars().collect();
    let mut out = Vec::new();
    let mut at = 0;
    while let Some(&c) = chars.get(at) {
        let column = at + 1;
        if c.is_whitespace() {
            at += 1;
            continue;
        }
        let (token, next) = if c.is_ascii_digit() || c == '.' {
            number(&chars, at)?
        } else if begins_name(c) {
            name(&chars, at)
        } else {
            sign(&chars, at)?
        };
        out.push(Placed { token, column });
        at = next;
    }
    out.push(Placed { token: Token::End, column: chars.len() + 1 });
    Ok(out)
}

fn number(chars: &[char], start: usize) -> Result<(Token, usize), CaseProblem> {
    let digits = |from: usize| chars[from..].iter().take_while(|c| c.is_ascii_digit()).count();
    let problem = |message: String| CaseProblem { column: start + 1, message };
    let mut end = start + digits(start);
    let mut any = end - start;
    if chars.get(end) == Some(&'.') {
        let after = digits(end + 1);
        any += after;
        end += 1 + after;
    }
    if any == 0 {
        return Err(problem("a point without digits".to_string()));
    }
    if matches!(chars.get(end), Some('e' | 'E')) {
        let signed = usize::from(matches!(chars.get(end + 1), Some('+' | '-')));
        let exponent = digits(end + 1 + signed);
        if exponent == 0 {
            return Err(problem("an exponent needs digits, as in 1e-3".to_string()));
        }
        end += 1 + signed + exponent;
    }
    let text: String = chars[start..end].iter().collect();
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((Token::Number(value), end)),
        _ => Err(problem(format!("{} is no finite number", quoted(&text)))),
    }
}

fn name(chars: &[char], start: usize) -> (Token, usize) {
    let inside = |c: &&char| begins_name(**c) || c.is_ascii_digit();
    let end = start + chars[start..].iter().take_while(inside).count();
    (Token::Name(chars[start..end].iter().collect()), end)
}

/// How temperatures are written.
pub(super) const TEMPERATURES: &str =
    "temperatures are differences in K, and a difference in degrees Celsius is the same number: \"60 K\"";

fn begins_name(c: char) -> bool {
    c.is_alphabetic() || c == '_' || c == '\u{b5}'
}

fn sign(chars: &[char], start: usize) -> Result<(Token, usize), CaseProblem> {
    let fits = |sign: &&&str| sign.chars().enumerate().all(|(i, c)| chars.get(start + i) == Some(&c));
    match SIGNS.iter().find(fits) {
        Some(sign) => Ok((Token::Sign(sign), start + sign.len())),
        None => {
            let degrees =
                if matches!(chars[start], '\u{b0}' | '\u{2103}') { format!(": {TEMPERATURES}") } else { String::new() };
            let message = format!("{} has no meaning in a formula{degrees}", quoted(&chars[start].to_string()));
            Err(CaseProblem { column: start + 1, message })
        }
    }
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => write!(f, "the number {value}"),
            Self::Name(name) => write!(f, "{}", quoted(name)),
            Self::Sign(sign) => write!(f, "\"{sign}\""),
            Self::End => f.write_str("the end"),
        }
    }
}
