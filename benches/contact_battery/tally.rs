//! Verdicts, and what they add up to by family.

use crate::judge::Check;

/// What came of a problem.
pub enum Verdict {
    Solved { newton: usize, checks: Vec<Check> },
    Wrong { checks: Vec<Check>, words: String },
    Failed(String),
    Cut(String),
    NoSolution(String),
}

impl Verdict {
    /// What is printed of it.
    pub fn words(&self) -> Option<&str> {
        match self {
            Verdict::Solved { .. } => None,
            Verdict::Wrong { words, .. }
            | Verdict::Failed(words)
            | Verdict::Cut(words)
            | Verdict::NoSolution(words) => Some(words),
        }
    }
}

/// By all checks.
pub fn judged(newton: usize, checks: Vec<Check>) -> Verdict {
    let told = |check: &Check| format!("{} {:.2e}, at most {:.0e}", check.name, check.off, check.most);
    let fails: Vec<String> = checks.iter().filter(|check| check.fails()).map(told).collect();
    match fails.is_empty() {
        true => Verdict::Solved { newton, checks },
        false => Verdict::Wrong { checks, words: format!("WRONG: {}", fails.join("; ")) },
    }
}

/// Of every check the one nearest to its bound.
pub fn keep_worst(worst: &mut Vec<Check>, checks: &[Check]) {
    for check in checks {
        match worst.iter_mut().find(|own| own.name == check.name) {
            Some(own) if check.off / check.most > own.off / own.most => *own = *check,
            Some(_) => {}
            None => worst.push(*check),
        }
    }
}

/// Of a family.
pub struct Tally {
    pub name: &'static str,
    pub solved: usize,
    pub wrong: usize,
    pub failed: usize,
    pub cut: usize,
    pub no_solution: usize,
    newton: Vec<usize>,
    seconds: f64,
}

impl Tally {
    pub fn of(name: &'static str) -> Self {
        Tally { name, solved: 0, wrong: 0, failed: 0, cut: 0, no_solution: 0, newton: Vec::new(), seconds: 0.0 }
    }

    pub fn add(&mut self, verdict: &Verdict, seconds: f64) {
        self.seconds += seconds;
        match verdict {
            Verdict::Solved { newton, .. } => {
                self.solved += 1;
                self.newton.push(*newton);
            }
            Verdict::Wrong { .. } => self.wrong += 1,
            Verdict::Failed(_) => self.failed += 1,
            Verdict::Cut(_) => self.cut += 1,
            Verdict::NoSolution(_) => self.no_solution += 1,
        }
    }

    fn problems(&self) -> usize {
        self.solved + self.wrong + self.failed + self.cut + self.no_solution
    }

    fn newton(&self, share: f64) -> usize {
        let mut sorted = self.newton.clone();
        sorted.sort_unstable();
        sorted.get((share * sorted.len() as f64) as usize).copied().unwrap_or(0)
    }

    pub fn line(&self) -> String {
        let Tally { name, solved, wrong, failed, cut, no_solution, seconds, .. } = self;
        let (problems, middle, most) = (self.problems(), self.newton(0.5), self.newton(0.9));
        format!(
            "| {name} | {problems} | {solved} | {failed} | {cut} | {wrong} | {no_solution} | {middle} | {most} | {seconds:.0} |"
        )
    }
}

/// All families, and their sum.
pub fn table(all: &[Tally]) -> String {
    let mut sum = Tally::of("all");
    for tally in all {
        sum.solved += tally.solved;
        sum.wrong += tally.wrong;
        sum.failed += tally.failed;
        sum.cut += tally.cut;
        sum.no_solution += tally.no_solution;
        sum.seconds += tally.seconds;
        sum.newton.extend(&tally.newton);
    }
    let head = "| family | problems | solved | failed | cut | wrong | without solution | Newton, median | 90 % | s |\n\
                |---|---|---|---|---|---|---|---|---|---|";
    let lines: Vec<String> = all.iter().chain([&sum]).map(Tally::line).collect();
    format!("{head}\n{}", lines.join("\n"))
}

/// How near answers come to the bounds of the judge.
pub fn checks(worst: &[Check]) -> String {
    let line = |check: &Check| format!("{:38} {:10.2e} of {:.0e}", check.name, check.off, check.most);
    worst.iter().map(line).collect::<Vec<_>>().join("\n")
}
