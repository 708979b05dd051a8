//! [`Real`]: the two precisions a factor may have.

use std::sync::Mutex;

use faer::traits::RealField;

use crate::locks::lock;

/// A precision fronts are eliminated in.
pub(super) trait Real: RealField + Copy + Send + Sync + 'static {
    /// Rounded.
    fn of(value: f64) -> Self;
    /// Exactly.
    fn double(self) -> f64;
    /// The buffers of this precision.
    fn buffers(workspace: &Workspace) -> &Mutex<Vec<Vec<Self>>>;
}

/// Memory of update matrices, kept between factorisations.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    double: Mutex<Vec<Vec<f64>>>,
    single: Mutex<Vec<Vec<f32>>>,
}

impl Workspace {
    pub fn bytes(&self) -> usize {
        let double: usize = lock(&self.double).iter().map(|buffer| size_of_val(buffer.as_slice())).sum();
        double + lock(&self.single).iter().map(|buffer| size_of_val(buffer.as_slice())).sum::<usize>()
    }

    pub fn clear(&self) {
        lock(&self.double).clear();
        lock(&self.single).clear();
    }
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn double(self) -> f64 {
        self
    }

    fn buffers(workspace: &Workspace) -> &Mutex<Vec<Vec<Self>>> {
        &workspace.double
    }
}

impl Real for f32 {
    fn of(value: f64) -> Self {
        value as f32
    }

    fn double(self) -> f64 {
        f64::from(self)
    }

    fn buffers(workspace: &Workspace) -> &Mutex<Vec<Vec<Self>>> {
        &workspace.single
    }
}
