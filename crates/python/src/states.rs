//! States as NumPy arrays.

use crate::error;
use crate::mesh::{arrays, matrix};
use nastic_case::lower::CaseProblem;
use nastic_control::ControlBlock;
use nastic_mesh::Snapshot;
use nastic_run::run;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};

/// The states that a command found.
#[pyclass(frozen, module = "nastic._nastic")]
pub(crate) struct States {
    pub states: run::States,
}

#[pymethods]
impl States {
    /// The mesh that all members share.
    fn mesh<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        arrays(py, self.states.problem().mesh())
    }

    /// Name, nodal and cell-wise fields of every member.
    fn members<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let states = &self.states;
        let shots = py.detach(|| {
            let of = |member: nastic_case::lower::CaseMember<'_>| Ok((member.name(), states.snapshot(member)?));
            states.problem().members().map(of).collect::<Result<Vec<_>, nastic_control::ControlError>>()
        });
        fields(py, shots.map_err(|problem| error::input(py, problem))?)
    }

    /// The values of every control by name.
    fn controls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        by_name(py, self.states.problem(), &self.states.point().m, ControlBlock::values_of)
    }

    /// The derivative by every control, where the command asked for it.
    fn derivative<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        self.states
            .derivative()
            .map(|derivative| by_name(py, self.states.problem(), derivative, |_, own| own.to_vec()))
            .transpose()
    }

    /// The picture of the first member as a PNG.
    fn picture<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.states.picture(self.states.problem().member(0)));
        Ok(PyBytes::new(py, &bytes.map_err(|problem| error::input(py, problem))?))
    }
}

/// Name, nodal and cell-wise fields of states.
pub(crate) fn fields<'py>(py: Python<'py>, shots: Vec<(String, Snapshot)>) -> PyResult<Bound<'py, PyList>> {
    let out = PyList::empty(py);
    for (name, shot) in shots {
        let one = PyDict::new(py);
        one.set_item("name", name)?;
        for (key, fields) in [("point_data", shot.point_data), ("cell_data", shot.cell_data)] {
            let of = PyDict::new(py);
            for field in fields {
                match field.components {
                    1 => of.set_item(field.name, PyArray1::from_vec(py, field.values))?,
                    9 => {
                        let count = field.values.len() / 9;
                        of.set_item(field.name, PyArray1::from_vec(py, field.values).reshape([count, 3, 3])?)?;
                    }
                    n => of.set_item(field.name, matrix(py, field.values, n)?)?,
                }
            }
            one.set_item(key, of)?;
        }
        out.append(one)?;
    }
    Ok(out)
}

/// A control vector, or a dual one, as arrays by name: `[unknowns]`, of vectors `[unknowns][components]`; `values` makes them of the part of a field.
fn by_name<'py>(
    py: Python<'py>,
    problem: &CaseProblem,
    m: &[f64],
    values: impl Fn(&ControlBlock, &[f64]) -> Vec<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    for (block, field) in problem.ensemble.blocks().iter().zip(&problem.controls) {
        let own = problem.control_block(block);
        let values = values(own, block.of(m));
        match own.components {
            1 => out.set_item(&field.name, PyArray1::from_vec(py, values))?,
            n => out.set_item(&field.name, matrix(py, values, n)?)?,
        }
    }
    Ok(out)
}
