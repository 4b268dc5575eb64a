#pragma once
// `halflight report DIR [--out DIR2]`: plots of a folder of results, without a window.

namespace hl {

/// argv[1] is "report". Prints what was written to stdout, errors as one line to stderr. Returns the exit code.
int report(int argc, char** argv);

}  // namespace hl
