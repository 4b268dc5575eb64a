#pragma once
// Work of the window's own that takes longer than an event may: on threads that give way to the window and to what is measured.

namespace hl::ui {

/// This thread alone, from now on: nice 10, as the session's.
void giveWay();

}  // namespace hl::ui
