//! What a plan leaves out or sums in single precision, added up: a bound of the error of every sum.

use super::bounds::Bounds;
use super::floor::Floor;
use super::kernel::Kernel;
use super::mask::Mask;
use super::side::Side;

/// Per chunk of rows and of columns, in parts of the sums at its points.
#[derive(Debug)]
pub(super) struct Account {
    rows: Vec<f64>,
    columns: Vec<f64>,
}

/// One side of an account.
#[derive(Clone, Copy)]
pub(super) struct Holder<'a> {
    pub side: &'a Side,
    pub floor: &'a Floor,
}

impl Account {
    pub fn new(rows: &Side, columns: &Side) -> Self {
        Self { rows: vec![0.0; rows.chunks.len()], columns: vec![0.0; columns.chunks.len()] }
    }

    /// All pairs of two nodes are left out.
    pub fn leave_out(&mut self, kernel: &Kernel, rows: (Holder, u32), columns: (Holder, u32)) {
        let (here, there) = (&rows.0.side.boxes[rows.1 as usize], &columns.0.side.boxes[columns.1 as usize]);
        let highest = kernel.at(here.gap(there));
        let part = |(here, node): (Holder, u32), (there, other): (Holder, u32)| {
            there.side.clusters[other as usize].share * power_above(highest - here.floor.lower[node as usize])
        };
        let (by_columns, by_rows) = (part(rows, columns), part(columns, rows));
        self.rows[rows.0.side.chunks_of(rows.1)].iter_mut().for_each(|sum| *sum += by_columns);
        self.columns[columns.0.side.chunks_of(columns.1)].iter_mut().for_each(|sum| *sum += by_rows);
    }

    /// Of two leaves only these blocks are summed, those in single precision with this relative error.
    pub fn tile(
        &mut self,
        kernel: &Kernel,
        (rows, row): (Holder, u32),
        (columns, column): (Holder, u32),
        (double, single): (Mask, Mask),
        error: f64,
    ) {
        for (i, row) in rows.side.chunks_of(row).enumerate() {
            for (j, column) in columns.side.chunks_of(column).enumerate() {
                if double.contains(i, j) {
                    continue;
                }
                let part = if single.contains(i, j) { error } else { 1.0 };
                let (here, there): (&Bounds, &Bounds) = (&rows.side.chunks[row], &columns.side.chunks[column]);
                let highest = kernel.at(here.gap(there));
                let of = |floor: &Floor, chunk: usize| part * power_above(highest - floor.chunks[chunk]);
                self.rows[row] += columns.side.chunk_share[column] * of(rows.floor, row);
                self.columns[column] += rows.side.chunk_share[row] * of(columns.floor, column);
            }
        }
    }

    pub fn add(&mut self, other: &Self) {
        self.rows.iter_mut().zip(&other.rows).for_each(|(sum, part)| *sum += part);
        self.columns.iter_mut().zip(&other.columns).for_each(|(sum, part)| *sum += part);
    }

    /// The largest error.
    pub fn worst(&self) -> f64 {
        self.rows.iter().chain(&self.columns).copied().fold(0.0, f64::max)
    }
}

/// At least 2^x, by at most 7 %: the chord between whole powers.
fn power_above(x: f64) -> f64 {
    let x = x.clamp(-1000.0, 1000.0);
    let whole = x.floor();
    f64::from_bits(((whole as i64 + 1023) as u64) << 52) * (1.0 + (x - whole))
}
