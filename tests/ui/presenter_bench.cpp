// What a frame costs on its way to the screen, read back and painted against drawn by the device, taken in turn in one run. Prints JSON, times in ms.
#include <time.h>

#include <QApplication>
#include <QElapsedTimer>
#include <QTimer>
#include <algorithm>
#include <cstdio>
#include <vector>

#include "engine/experiment/preset.h"
#include "ui/session_link.h"
#include "ui/swapchain_view.h"
#include "ui/viewport.h"

namespace {

using namespace hl;
using namespace hl::ui;

constexpr int kRounds = 6, kFrames = 12, kLongest = 120000;

double threadCpuMs() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v.empty() ? 0 : v[v.size() / 2];
}

template <class Done>
bool waitFor(const Done& done) {
  QElapsedTimer clock;
  clock.start();
  QTimer tick;  // so that waiting ends; it must not spin, for its time is the thread's
  tick.start(5);
  while (!done() && clock.elapsed() < kLongest) QCoreApplication::processEvents(QEventLoop::WaitForMoreEvents);
  return done();
}

struct Figures {
  std::vector<double> publish, window;
};

bool measure(SessionLink& link, Figures& f) {
  for (int i = 0; i < kFrames; ++i) {
    const uint64_t before = link.latest()->number;
    const double cpu = threadCpuMs();
    link.renderOnce();
    // Waiting costs the thread next to nothing; handling the frame and painting it is what is left.
    if (!waitFor([&] { return link.latest()->number > before; })) return false;
    QCoreApplication::processEvents();
    QCoreApplication::processEvents();
    f.window.push_back(threadCpuMs() - cpu);
    f.publish.push_back(link.latest()->publishMs);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  QApplication app(argc, argv);
  SessionOptions options;
  SessionLink link(options);
  std::shared_ptr<Presenter> presenter;
  QObject::connect(&link, &EngineLink::presenterReady, [&](const std::shared_ptr<Presenter>& p) { presenter = p; });
  QObject::connect(&link, &EngineLink::failed, [](const QString& m) { std::fprintf(stderr, "%s\n", qPrintable(m)); });
  std::printf("[");
  for (const QSize size : {QSize(640, 360), QSize(1920, 1080)}) {
    Preset p;
    p.technique = "none";
    p.width = size.width(), p.height = size.height();
    p.parameters = {{"direct.samples", "1"}};
    link.load(p);
    Viewport viewport;
    viewport.setFixedSize(size);
    QObject::connect(&link, &EngineLink::frameReady, &viewport, [&] { viewport.showFrame(link.latest()); });
    viewport.show();
    const auto ready = [&] { return presenter && link.latest() && link.latest()->width == size.width() && link.latest()->settled; };
    if (!waitFor(ready)) return 1;
    link.setPaused(true);
    Figures readBack, swapchain, warm;
    for (int round = 0; round <= kRounds; ++round)
      for (const bool device : {false, true}) {
        viewport.usePresenter(device ? presenter : nullptr);
        if (device && !waitFor([&] { return viewport.swapchainView()->isShown(); })) return 1;
        if (!measure(link, round == 0 ? warm : device ? swapchain : readBack)) return 1;
      }
    viewport.usePresenter(nullptr);
    link.setPaused(false);
    std::printf("%s{\"size\": \"%dx%d\", \"frames\": %zu, \"publish\": {\"readback\": %.3f, \"swapchain\": %.3f}, \"window_thread_cpu\": {\"readback\": %.3f, \"swapchain\": %.3f}}", size.width() == 640 ? "" : ",\n ",
                size.width(), size.height(), readBack.publish.size(), median(readBack.publish), median(swapchain.publish), median(readBack.window), median(swapchain.window));
    std::fflush(stdout);
  }
  std::printf("]\n");
}
