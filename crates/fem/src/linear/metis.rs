//! METIS' nested dissection: C code, and the only foreign call of the project; behind the feature `metis`.

use super::locks::lock;
use std::sync::Mutex;

/// METIS draws from one random generator of the C library, seeded at every call.
static GENERATOR: Mutex<()> = Mutex::new(());

/// The node to be eliminated k-th, for every k, of a graph given by the neighbours `rows[starts[i]..starts[i + 1]]` of
/// every node `i`; nothing if METIS refuses.
///
/// Source: G. Karypis, V. Kumar, SIAM J. Sci. Comput. 20 (1998), `METIS_NodeND` with default options.
#[allow(unsafe_code)] // the one place for it
pub(super) fn nested_dissection(starts: &[i32], rows: &[i32]) -> Option<Vec<u32>> {
    let nodes = starts.len().checked_sub(1)?;
    let sound = starts.windows(2).all(|w| 0 <= w[0] && w[0] <= w[1])
        && starts.last().is_some_and(|&end| end as usize == rows.len())
        && rows.iter().all(|&other| usize::try_from(other).is_ok_and(|other| other < nodes));
    if !sound || nodes == 0 {
        return None;
    }
    let (mut starts, mut rows) = (starts.to_vec(), rows.to_vec());
    let (mut new_to_old, mut old_to_new) = (vec![0i32; nodes], vec![0i32; nodes]);
    let mut count = i32::try_from(nodes).ok()?;
    let _alone = lock(&GENERATOR);
    // SAFETY: `starts` and `rows` are a graph of `count` nodes as checked above, both orders have room for `count` numbers,
    // all of them outlive the call and nobody else sees them; null asks for no weights and for default options.
    let status = unsafe {
        metis_sys::METIS_NodeND(
            &raw mut count,
            starts.as_mut_ptr(),
            rows.as_mut_ptr(),
            std::ptr::null_mut(),
            std::ptr::null_mut(),
            new_to_old.as_mut_ptr(),
            old_to_new.as_mut_ptr(),
        )
    };
    let order = new_to_old.into_iter().map(|node| u32::try_from(node).ok()).collect::<Option<Vec<u32>>>()?;
    (status == metis_sys::rstatus_et_METIS_OK).then_some(order)
}
