#!/bin/sh
# What .ci/run compiles crates of the workspace with (RUSTC_WORKSPACE_WRAPPER): rustc, without optimisation for what reads cases and writes results, and where a
# test program drives whole cases, or checks text, and spends its time in the libraries of numbers, which stay optimised. Test programs that compute themselves,
# by generic functions of the libraries that are compiled in them, would run two to three times longer: those of fem, control, linear, mesh, hausdorff. So would
# everything behind language, whose catalogue makes the laws: their generic functions are compiled in it.
# Examples compile in a tenth of the time at level 1, which shares generic functions of the libraries.
# Without optimisation arithmetic is the same, bit by bit.
compiler="$1"
shift
case " $* " in
  *" --test "*)
    case "$*" in
      *" crates/run/tests/"* | *" crates/cli/tests/"* | *" crates/language/"* | *" crates/report/"* | *" crates/case/"* | *" crates/picture/"* | *" crates/opt/tests/"* | \
        *" crates/energy/tests/"* | *" crates/ensemble/tests/"* | *" crates/uncertainty/tests/"* | *" tests/all.rs "* | \
        *" crates/body/src/"* | *" crates/equilibrium/src/"* | *" crates/forces/src/"* | *" crates/linear/src/"* | *" crates/io/"*)
        set -- "$@" -C opt-level=0 ;;
    esac ;;
  *" examples/"*.rs\ *)
    set -- "$@" -C opt-level=1 ;;
  *" --crate-name nastic_case "* | *" --crate-name nastic_report "* | *" --crate-name nastic_result "* | \
    *" --crate-name nastic_run "* | *" --crate-name nastic_cli "* | *" --crate-name nastic "*" crates/cli/"* | *" crates/python/"*)
    set -- "$@" -C opt-level=0 ;;
esac
exec "$compiler" "$@"
