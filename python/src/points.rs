//! Points from Python, and arrays for it.

use cohaul::math::Vec2;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::GILOnceCell;
use pyo3::types::{PyBool, PyBytes, PyList, PyTuple};

use crate::options::refused;

/// Largest coordinate (m): beyond it, squares of distances are no longer finite.
pub const LARGEST: f64 = 1e60;

/// Reads one point (m) from each entry of `value`: a list, a tuple or an array of pairs.
///
/// `is_read` says which entries count; the others may be anything that is a pair of numbers.
///
/// # Errors
/// When the number of entries is not `n`, an entry is no pair, or a coordinate is not finite.
pub fn points(value: &Bound<PyAny>, n: usize, out: &mut Vec<Vec2>, is_read: impl Fn(usize) -> bool) -> PyResult<()> {
    out.clear();
    let list = listed(value)?;
    let found = each(list.as_ref().unwrap_or(value), "tips", |at, entry| {
        if at < n {
            let position = pair(entry, || format!("tips[{at}]"))?;
            if is_read(at) {
                finite(&position, || format!("tips[{at}]"))?;
            }
            out.push(position);
        }
        Ok(())
    })?;
    match found == n {
        true => Ok(()),
        false => Err(PyValueError::new_err(format!("tips: must have one point (x, y) for each of the {n} springs, found {found}"))),
    }
}

/// One finite point (m).
///
/// # Errors
/// When it is no pair of finite numbers.
pub fn point(value: &Bound<PyAny>) -> PyResult<Vec2> {
    let list = listed(value)?;
    let position = pair(list.as_ref().unwrap_or(value), || "tip".to_owned())?;
    finite(&position, || "tip".to_owned())?;
    Ok(position)
}

/// An index below `n` of what `path` names.
///
/// # Errors
/// When it is no whole number, or there is none of this index.
pub fn index(value: &Bound<PyAny>, path: &str, n: usize) -> PyResult<usize> {
    if value.is_instance_of::<PyBool>() || !value.hasattr("__index__")? {
        return Err(not_a(path, "a whole number", value));
    }
    match value.extract::<usize>() {
        Ok(index) if index < n => Ok(index),
        _ if n == 0 => Err(refused(path, "must be one of the scenario, which has none", value)),
        _ => Err(refused(path, &format!("must be from 0 to {}", n - 1), value)),
    }
}

/// The entries of an array as a list; `None` for anything else, which is read as it is.
fn listed<'py>(value: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
    if value.is_instance_of::<PyTuple>() || value.is_instance_of::<PyList>() {
        return Ok(None);
    }
    value.getattr_opt("tolist")?.map(|tolist| tolist.call0()).transpose()
}

/// Calls `read` with each entry of a list or a tuple, and returns their number.
fn each<'py>(value: &Bound<'py, PyAny>, path: &str, mut read: impl FnMut(usize, &Bound<'py, PyAny>) -> PyResult<()>) -> PyResult<usize> {
    if let Ok(list) = value.downcast::<PyList>() {
        list.iter().enumerate().try_for_each(|(at, entry)| read(at, &entry))?;
        return Ok(list.len());
    }
    let tuple = value.downcast::<PyTuple>().map_err(|_| not_a(path, "a list, a tuple or an array of points (x, y)", value))?;
    tuple.iter().enumerate().try_for_each(|(at, entry)| read(at, &entry))?;
    Ok(tuple.len())
}

fn pair(value: &Bound<PyAny>, path: impl Fn() -> String) -> PyResult<Vec2> {
    let number = |entry: &Bound<PyAny>| entry.extract::<f64>().map_err(|_| not_a(&path(), "a pair of numbers (m)", value));
    if let Ok(tuple) = value.downcast::<PyTuple>()
        && tuple.len() == 2
    {
        return Ok(Vec2::new(number(&tuple.get_item(0)?)?, number(&tuple.get_item(1)?)?));
    }
    if let Ok(list) = value.downcast::<PyList>()
        && list.len() == 2
    {
        return Ok(Vec2::new(number(&list.get_item(0)?)?, number(&list.get_item(1)?)?));
    }
    match listed(value)?.filter(|list| list.is_instance_of::<PyList>()) {
        Some(list) => pair(&list, path),
        None => Err(not_a(&path(), "a pair of numbers (m)", value)),
    }
}

fn finite(position: &Vec2, path: impl Fn() -> String) -> PyResult<()> {
    match [position.x, position.y].into_iter().find(|value| value.is_nan() || value.abs() > LARGEST) {
        Some(value) => Err(PyValueError::new_err(format!("{}: must be finite and at most {LARGEST:e} m in size, found {value}", path()))),
        None => Ok(()),
    }
}

fn not_a(path: &str, what: &str, value: &Bound<PyAny>) -> PyErr {
    let found = value.get_type().name().map_or_else(|_| "something else".to_owned(), |name| name.to_string());
    PyTypeError::new_err(format!("{path}: must be {what}, found {found}"))
}

/// A read-only array of points: rows of two numbers.
pub fn point_array<'py>(py: Python<'py>, values: impl Iterator<Item = Vec2>) -> PyResult<Bound<'py, PyAny>> {
    array_of(py, values.flat_map(|value| [value.x, value.y]), 2)
}

/// A read-only array of rows of so many numbers.
pub fn array_of<'py>(py: Python<'py>, values: impl Iterator<Item = f64>, width: usize) -> PyResult<Bound<'py, PyAny>> {
    static FROM_BUFFER: GILOnceCell<Py<PyAny>> = GILOnceCell::new();
    let bytes: Vec<u8> = values.flat_map(f64::to_ne_bytes).collect();
    if bytes.is_empty() {
        return py.import("numpy")?.call_method1("zeros", ((0, width),));
    }
    let from_buffer = FROM_BUFFER.get_or_try_init(py, || py.import("numpy")?.getattr("frombuffer").map(Bound::unbind))?;
    from_buffer.bind(py).call1((PyBytes::new(py, &bytes),))?.call_method1("reshape", (-1, width))
}

/// The numbers of an array in memory, as its `tobytes` gives them.
pub fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks().0.iter().copied().map(f64::from_ne_bytes).collect()
}
