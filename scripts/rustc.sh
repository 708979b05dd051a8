#!/bin/sh
# What .ci/run compiles crates of the workspace with (RUSTC_WORKSPACE_WRAPPER): rustc, without optimisation where a test program drives whole
# cases, or checks text, and spends its time in the libraries, which stay optimised. Test programs that compute themselves, by generic functions
# of the libraries that are compiled in them, would run two to three times longer: those of fem, control, linear, mesh, hausdorff.
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
esac
exec "$compiler" "$@"
