#include "engine/session/presenter.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "engine/core/math.h"
#include "engine/gpu/frame_graph.h"
#include "engine/gpu/shader_library.h"
#include "engine/gpu/swapchain.h"

namespace hl {
namespace {

// A window that gives no image in that time is left as it is, and tried again later: the session must go on.
constexpr int kAcquireMs = 50;
constexpr std::chrono::milliseconds kTryAgain{20};

/// Push constants of passes/present.frag.
struct PresentConstants {
  vec4 picture, background;
};

}  // namespace

struct Presenter::Impl {
  // Fixed.
  Device* device;  ///< until end()
  std::shared_ptr<void> instance;
  std::string noPresentation, deviceName;
  bool cpu;

  mutable std::mutex mutex;
  std::condition_variable wake, changed;
  std::thread thread;
  uint64_t surface = 0, inUse = 0;  ///< wanted; that of the thread's swapchain
  std::function<void(const std::string&)> answer;
  PresentView view;
  bool stop = false, ended = false, visible = true, redraw = false;
  bool busy = false, taking = false;  ///< the thread is at work; at a picture
  GpuImage offered;  ///< the session's, while it waits
  PresentReport report;

  // The thread's own.
  std::unique_ptr<ShaderLibrary> shaders;
  std::unique_ptr<FrameGraph> graph;
  std::unique_ptr<Swapchain> swapchain;
  GpuImage kept, none, overlayImage;
  std::shared_ptr<const Overlay> uploaded;

  explicit Impl(Device& d) : device(&d), instance(Swapchain::instanceOf(d)), noPresentation(Swapchain::unavailable(d)), deviceName(d.info().name), cpu(d.isCpu()) {}

  uint64_t builtBefore = 0;  ///< of the swapchain, and counted already
  bool announced = false;    ///< that the window is drawn

  struct Asked {
    uint64_t surface = 0;
    GpuImage picture;
    PresentView view;
    bool visible = false;
  };
  void run();
  bool serve(const Asked&);
  void use(uint64_t wanted);
  void makeGraph();
  bool draw(const PresentView&);
  void keep(const GpuImage&);
  void useOverlay(const std::shared_ptr<const Overlay>&);
  void refuse(const std::string& why);
};

void Presenter::Impl::makeGraph() {
  if (graph) return;
  shaders = std::make_unique<ShaderLibrary>(*device);
  graph = std::make_unique<FrameGraph>(*device, *shaders);
}

void Presenter::Impl::keep(const GpuImage& picture) {
  makeGraph();
  if (!kept || kept.width() != picture.width() || kept.height() != picture.height()) kept = device->image("shown picture", {picture.width(), picture.height(), picture.format()});
  graph->copy("present: keep", picture, kept);
  graph->execute();
}

void Presenter::Impl::useOverlay(const std::shared_ptr<const Overlay>& overlay) {
  if (overlay == uploaded) return;
  if (overlay) {
    if (!overlayImage || overlayImage.width() != overlay->width || overlayImage.height() != overlay->height)
      overlayImage = device->image("overlay", {overlay->width, overlay->height, Format::RGBA8});
    device->upload(overlayImage, 0, overlay->rgba.data(), overlay->rgba.size());
  }
  uploaded = overlay;
}

/// False where it has to be tried again.
bool Presenter::Impl::draw(const PresentView& v) {
  makeGraph();
  useOverlay(v.overlay);
  const GpuImage target = swapchain->acquire(kAcquireMs);
  if (!target) return false;
  const bool picture = v.picture && kept;
  // What a variant of the shader never reads has to be bound all the same.
  if (!none) {
    none = device->image("nothing", {1, 1, Format::RGBA8});
    graph->clear("present: nothing", none);
  }
  graph->raster("present", "passes/surfaces.vert", "passes/present.frag", {{target}, {}})
      .sample("picture", picture ? kept : none)
      .sample("overlay", uploaded ? overlayImage : none)
      .specialize("kPicture", picture ? 1 : 0)
      .specialize("kSmooth", v.smooth ? 1 : 0)
      .specialize("kOverlay", uploaded ? 1 : 0)
      .push(PresentConstants{vec4(v.x, v.y, std::max(v.width, 1.0f), std::max(v.height, 1.0f)), vec4(v.background[0], v.background[1], v.background[2], 1)})
      .draw(3);
  graph->execute();
  if (!swapchain->present()) return false;
  const std::lock_guard lock(mutex);
  ++report.presented;
  report.width = target.width(), report.height = target.height();
  return true;
}

/// No more of this window.
void Presenter::Impl::refuse(const std::string& why) {
  std::function<void(const std::string&)> told;
  {
    const std::lock_guard lock(mutex);
    surface = 0;
    told = std::exchange(answer, {});
  }
  if (told) told(why);
}

/// Another window, or none.
void Presenter::Impl::use(uint64_t wanted) {
  swapchain.reset();
  builtBefore = 0;
  announced = false;
  {
    const std::lock_guard lock(mutex);
    inUse = 0;
  }
  changed.notify_all();
  if (wanted == 0) return;
  swapchain = std::make_unique<Swapchain>(*device, wanted);
  const std::lock_guard lock(mutex);
  inUse = wanted;
}

/// False where it has to be tried again.
bool Presenter::Impl::serve(const Asked& asked) {
  if (asked.surface != inUse) use(asked.surface);  // inUse: written by this thread alone
  if (asked.picture) keep(asked.picture);
  if (!swapchain || !asked.visible) return true;
  const bool drawn = draw(asked.view);
  std::function<void(const std::string&)> told;
  {
    const std::lock_guard lock(mutex);
    report.swapchains += swapchain->built() - builtBefore;
    if (drawn && asked.picture) ++report.pictures;
    if (drawn && !announced) told = answer;
  }
  builtBefore = swapchain->built();
  if (drawn && !std::exchange(announced, true) && told) told({});
  return drawn;
}

void Presenter::Impl::run() {
  bool again = false;
  while (true) {
    Asked asked;
    {
      std::unique_lock lock(mutex);
      const auto due = [&] { return stop || surface != inUse || offered || (redraw && visible && surface != 0); };
      if (again)
        wake.wait_for(lock, kTryAgain, due);
      else
        wake.wait(lock, due);
      if (stop) break;
      asked = {surface, std::exchange(offered, {}), view, visible};
      busy = true, taking = static_cast<bool>(asked.picture);
      redraw = false;
    }
    try {
      again = !serve(asked);
    } catch (const std::exception& e) {
      again = false;
      graph.reset();  // with what was recorded
      swapchain.reset();
      {
        const std::lock_guard lock(mutex);
        inUse = 0;
      }
      refuse(e.what());
    }
    {
      const std::lock_guard lock(mutex);
      busy = taking = false;
    }
    changed.notify_all();
  }
  swapchain.reset();
  graph.reset();
  shaders.reset();
  kept = none = overlayImage = {};
  const std::lock_guard lock(mutex);
  inUse = 0;
  ended = true;
  changed.notify_all();
}

Presenter::Presenter(Device& device) : impl_(std::make_unique<Impl>(device)) {}
Presenter::~Presenter() { end(); }

void* Presenter::vulkanInstance() const { return impl_->instance.get(); }
const std::string& Presenter::noPresentation() const { return impl_->noPresentation; }
const std::string& Presenter::deviceName() const { return impl_->deviceName; }
bool Presenter::ofCpu() const { return impl_->cpu; }

void Presenter::attach(uint64_t surface, std::function<void(const std::string&)> answer) {
  std::string gone;
  {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->stop || impl_->ended) gone = "the engine has ended";
    if (!impl_->noPresentation.empty()) gone = impl_->noPresentation;
    if (gone.empty()) {
      if (!impl_->thread.joinable()) impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
      impl_->surface = surface;
      impl_->answer = std::move(answer);
      impl_->redraw = true;
    }
  }
  if (!gone.empty()) answer(gone);
  impl_->wake.notify_all();
}

void Presenter::detach() {
  std::unique_lock lock(impl_->mutex);
  impl_->surface = 0;
  impl_->answer = {};
  if (!impl_->thread.joinable()) return;
  impl_->wake.notify_all();
  impl_->changed.wait(lock, [this] { return impl_->ended || (impl_->inUse == 0 && !impl_->busy); });
}

void Presenter::setView(const PresentView& view) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->view = view;
    impl_->redraw = true;
  }
  impl_->wake.notify_all();
}

void Presenter::setVisible(bool visible) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->visible = visible;
    impl_->redraw = true;
  }
  impl_->wake.notify_all();
}

PresentReport Presenter::report() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->report;
}

bool Presenter::attached() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->surface != 0;
}

void Presenter::publish(const GpuImage& picture) {
  std::unique_lock lock(impl_->mutex);
  if (!impl_->thread.joinable() || impl_->ended || impl_->stop || impl_->surface == 0) return;
  impl_->offered = picture;
  impl_->wake.notify_all();
  impl_->changed.wait(lock, [this] { return impl_->ended || (!impl_->offered && !impl_->taking); });
}

void Presenter::end() {
  std::thread thread;
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stop = true;
    thread = std::move(impl_->thread);
  }
  impl_->wake.notify_all();
  if (thread.joinable()) thread.join();
}

}  // namespace hl
