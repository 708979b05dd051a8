//! Walks the tree of tasks, on one thread or on all.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::symbolic::Task;

/// Does every task after all its children. A task that returns false is not followed by its ancestors.
pub(super) fn upwards(tasks: &[Task], parallel: bool, work: impl Fn(&Task) -> bool + Sync) {
    if !parallel {
        // Tasks are in postorder; the first one that fails is the first in elimination order.
        tasks.iter().take_while(|task| work(task)).for_each(drop);
        return;
    }
    let unfinished: Vec<AtomicUsize> = tasks.iter().map(|task| AtomicUsize::new(task.children.len())).collect();
    let climb = |leaf: &Task| {
        let mut task = leaf;
        while work(task) {
            match task.parent {
                Some(parent) if unfinished[parent].fetch_sub(1, Ordering::AcqRel) == 1 => task = &tasks[parent],
                _ => return,
            }
        }
    };
    rayon::scope(|scope| {
        for leaf in tasks.iter().filter(|task| task.children.is_empty()) {
            let climb = &climb;
            scope.spawn(move |_| climb(leaf));
        }
    });
}

/// Does every task after its parent.
pub(super) fn downwards(tasks: &[Task], parallel: bool, work: impl Fn(&Task) + Sync) {
    if !parallel {
        tasks.iter().rev().for_each(work);
        return;
    }
    rayon::scope(|scope| {
        for root in tasks.iter().filter(|task| task.parent.is_none()) {
            let work = &work;
            scope.spawn(move |scope| descend(tasks, root, work, scope));
        }
    });
}

fn descend<'s, W: Fn(&Task) + Sync>(tasks: &'s [Task], root: &'s Task, work: &'s W, scope: &rayon::Scope<'s>) {
    let mut task = root;
    loop {
        work(task);
        let Some((&last, others)) = task.children.split_last() else { return };
        for &child in others {
            scope.spawn(move |scope| descend(tasks, &tasks[child], work, scope));
        }
        task = &tasks[last];
    }
}
