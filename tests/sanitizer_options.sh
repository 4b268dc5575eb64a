# Sourced by tests/run.sh; by hand too, before a sanitized test or program is run. A program without sanitizers ignores them.
halflight_suppressions="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/suppressions"
# Without intercept_tls_get_addr=0 the leak check guesses where the thread-local blocks of dlopened modules end, from what malloc keeps before them;
# glibc 2.36 aligns those blocks within larger ones, and at times the guess is a wild address that ends the program. Without it, fewer roots, so no leak is missed.
export ASAN_OPTIONS="intercept_tls_get_addr=0:detect_leaks=1:strict_string_checks=1:detect_stack_use_after_return=1:check_initialization_order=1"
export UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1"
export LSAN_OPTIONS="suppressions=$halflight_suppressions/lsan.txt:print_suppressions=0"
export TSAN_OPTIONS="suppressions=$halflight_suppressions/tsan.txt:halt_on_error=0:second_deadlock_stack=1"
