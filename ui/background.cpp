#include "ui/background.h"

#include <sys/resource.h>
#include <unistd.h>

namespace hl::ui {

void giveWay() { setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10); }

}  // namespace hl::ui
