//! [`ErrorRecord`]: what `--json` prints of a command without a result.

records! {
    /// A command without a result.
    ErrorRecord {
        /// The command.
        command: String,
        /// Its exit code.
        exit: u8,
        /// Why.
        error: String,
        /// What is wrong with the input.
        problems: Option<Vec<ProblemRecord>>,
        /// The last good state of a solve that failed.
        last_good_state: Option<String>,
    }

    /// What is wrong at a place of the input.
    ProblemRecord {
        /// The file.
        file: String,
        /// The place in the case.
        path: String,
        /// Line, from 1; 0 where there is none.
        line: usize,
        /// Column.
        column: usize,
        /// What is wrong.
        message: String,
    }
}
