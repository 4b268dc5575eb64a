// The picture drawn by the device into a window of its own, on a real X server: what is on the screen is what was published, through everything that happens to
// a window. No window manager is needed: Qt floats and resizes by itself.
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QGuiApplication>
#include <QLabel>
#include <QMainWindow>
#include <QMimeData>
#include <QScreen>
#include <QTemporaryDir>
#include <QTest>
#include <QToolButton>
#include <QWindow>
#include <cmath>

#include "engine/core/log.h"
#include "engine/experiment/preset.h"
#include "ui/main_window.h"
#include "ui/session_link.h"
#include "ui/settings.h"
#include "ui/swapchain_view.h"
#include "ui/viewport.h"

namespace {

using namespace hl;
using namespace hl::ui;

constexpr int kLongest = 240000;  // ms, on a busy machine
constexpr int kWidth = 96, kHeight = 54;

std::atomic<int> vulkanMessages{0};

Preset smallPreset() {
  Preset p;
  p.width = kWidth, p.height = kHeight;
  p.technique = "radiosity";
  p.parameters = {{"lightmap.resolution", "32"}, {"radiosity.samples", "16"}, {"radiosity.bounces", "2"}, {"direct.samples", "4"}, {"direct.lumel_samples", "4"}};
  return p;
}

/// The log has one further receiver, and a window's Log dock takes it: to be called after each is made or gone.
void listen() {
  setLogSink([](LogLevel level, std::string_view text) {
    if (level == LogLevel::Error && text.starts_with("Vulkan:")) ++vulkanMessages;
  });
}

class SwapchainTest : public QObject {
  Q_OBJECT

  QTemporaryDir folder_;
  std::unique_ptr<Settings> settings_;
  std::unique_ptr<SessionLink> link_;
  std::unique_ptr<MainWindow> window_;
  std::shared_ptr<Presenter> presenter_;

  /// The viewport as the screen shows it.
  static QImage onScreen(const QWidget& w) {
    const QPoint at = w.mapToGlobal(QPoint());
    return w.screen()->grabWindow(0, at.x(), at.y(), w.width(), w.height()).toImage().convertToFormat(QImage::Format_RGB32);
  }
  /// The newest frame, settled and with its bytes: what has been published lately is what the window has to show.
  std::shared_ptr<const FrameResult> settledFrame() {
    link_->setImagesWanted({"display"});
    const auto done = [&] {
      const auto f = link_->latest();
      return f && f->settled && !f->display.empty();
    };
    return QTest::qWaitFor(done, kLongest) ? link_->latest() : nullptr;
  }
  /// How many of the viewport's pixels are not those of the frame's RGBA8, each of them enlarged a whole number of times.
  int wrongPixels(const Viewport& viewport, const FrameResult& f) {
    const QImage screen = onScreen(viewport);
    if (screen.size() != viewport.size()) return -1;
    const QRectF r = viewport.pictureRect();
    const double x0 = std::round(r.x()), y0 = std::round(r.y());
    int wrong = 0;
    for (int y = 0; y < screen.height(); ++y)
      for (int x = 0; x < screen.width(); ++x) {
        const int px = static_cast<int>(std::floor((x + 0.5 - x0) / r.width() * f.width)), py = static_cast<int>(std::floor((y + 0.5 - y0) / r.height() * f.height));
        QRgb expected = qRgb(38, 38, 38);
        if (px >= 0 && py >= 0 && px < f.width && py < f.height) {
          const unsigned char* p = &f.display[static_cast<size_t>(py * f.width + px) * 4];
          expected = qRgb(p[0], p[1], p[2]);
        }
        if (screen.pixel(x, y) != expected) ++wrong;
      }
    return wrong;
  }
  /// The screen comes to show the settled frame, every pixel of it; it may take a redraw.
  bool showsTheFrame(const Viewport& viewport) {
    if (!QTest::qWaitFor([&] { return viewport.swapchainView() && viewport.swapchainView()->isShown(); }, kLongest)) return false;
    const auto frame = settledFrame();
    if (!frame) return false;
    int wrong = -1;
    const bool shown = QTest::qWaitFor(
        [&] {
          // A later frame may have come, after whatever changed last.
          const auto now = link_->latest();
          wrong = now && !now->display.empty() ? wrongPixels(viewport, *now) : -1;
          return wrong == 0;
        },
        60000);
    if (!shown) {
      onScreen(viewport).save(QStringLiteral("swapchain_test_failed.png"));
      qWarning("%d of %d pixels are wrong; what was on the screen is in swapchain_test_failed.png", wrong, viewport.width() * viewport.height());
    }
    return shown;
  }
  bool pixelComes(const Viewport& viewport, QPoint at, QRgb colour) {
    return QTest::qWaitFor([&] { return onScreen(viewport).pixel(at) == colour; }, kLongest);
  }
  /// One frame more has been published, and shown if it is to be.
  bool anotherFrame() {
    const uint64_t before = link_->latest()->number;
    link_->renderOnce();
    return QTest::qWaitFor([&] { return link_->latest()->number > before; }, kLongest);
  }
  void drop(const QString& path) {
    QMimeData file;
    file.setUrls({QUrl::fromLocalFile(path)});
    QDragEnterEvent enter(QPoint(10, 10), Qt::CopyAction, &file, Qt::LeftButton, Qt::NoModifier);
    QCoreApplication::sendEvent(window_.get(), &enter);
    QVERIFY(enter.isAccepted());
    QDropEvent event(QPointF(10, 10), Qt::CopyAction, &file, Qt::LeftButton, Qt::NoModifier);
    QCoreApplication::sendEvent(window_.get(), &event);
  }
  Viewport& viewport() { return window_->viewport(); }
  QDockWidget* dock(const char* name) { return window_->findChild<QDockWidget*>(QLatin1String(name)); }

 private slots:
  void initTestCase() {
    QCOMPARE(QGuiApplication::platformName(), QString("xcb"));
    savePreset(smallPreset(), folder_.filePath("small.json").toStdString());
    settings_ = std::make_unique<Settings>(folder_.filePath("settings.ini"));
    SessionOptions options;
    options.device.validation = true;
    link_ = std::make_unique<SessionLink>(options);
    connect(link_.get(), &EngineLink::presenterReady, this, [this](const std::shared_ptr<Presenter>& p) { presenter_ = p; });
    window_ = std::make_unique<MainWindow>(*link_, *settings_, folder_.filePath("small.json"));
    listen();
    window_->setPresenterWish(PresenterWish::Swapchain);
    window_->show();
    window_->resize(1100, 900);
    viewport().setFixedSize(4 * kWidth, 4 * kHeight);
    QVERIFY(QTest::qWaitFor([&] { return presenter_ && link_->latest(); }, kLongest));
  }
  void cleanupTestCase() {
    window_.reset();
    presenter_.reset();
    link_.reset();
    setLogSink({});
    QCOMPARE(vulkanMessages.load(), 0);
  }
  void cleanup() { QCOMPARE(vulkanMessages.load(), 0); }

  void theChoiceFollowsTheRule() {
    const QString xcb = QStringLiteral("xcb");
    QVERIFY(choosePresenter(PresenterWish::Swapchain, xcb, presenter_.get()).swapchain);
    QCOMPARE(choosePresenter(PresenterWish::Auto, xcb, presenter_.get()).swapchain, !presenter_->ofCpu());
    QVERIFY(!choosePresenter(PresenterWish::ReadBack, xcb, presenter_.get()).swapchain);
    const PresenterChoice elsewhere = choosePresenter(PresenterWish::Swapchain, QStringLiteral("wayland"), presenter_.get());
    QVERIFY(!elsewhere.swapchain && elsewhere.why.contains("wayland"));
    QVERIFY(!choosePresenter(PresenterWish::Swapchain, xcb, nullptr).swapchain);
    QVERIFY(!parsePresenterWish("both"));
  }

  void theScreenShowsWhatWasPublished() {
    QVERIFY(showsTheFrame(viewport()));
    QVERIFY2(window_->presenterText().startsWith("swapchain on"), qPrintable(window_->presenterText()));
    // Nobody asks for the bytes any more: they are not read back.
    link_->setImagesWanted({});
    QVERIFY(QTest::qWaitFor([&] { return link_->latest()->display.empty(); }, kLongest));
    QVERIFY(link_->latest()->displayHash.empty());
  }

  void aResizedWindowIsDrawnAnew() {
    const uint64_t before = presenter_->report().swapchains;
    for (const int scale : {3, 6, 5}) {
      viewport().setFixedSize(scale * kWidth + 20, scale * kHeight + 8);  // with a margin
      QVERIFY(showsTheFrame(viewport()));
    }
    QVERIFY(presenter_->report().swapchains >= before + 3);
    viewport().setFixedSize(4 * kWidth, 4 * kHeight);
    QVERIFY(showsTheFrame(viewport()));
  }

  void docksFloatTabifyAndClose() {
    int place = 0;
    for (QDockWidget* d : window_->docks()) {
      d->setFloating(true);
      d->move(1150, 20 + 60 * place++);  // not over the picture
    }
    QVERIFY(showsTheFrame(viewport()));
    for (QDockWidget* d : window_->docks()) d->close();
    QVERIFY(showsTheFrame(viewport()));
    for (const char* layout : {"compare", "profile", "tune"}) {
      window_->switchLayout(layout);
      window_->resetLayout();
      QVERIFY(showsTheFrame(viewport()));
    }
    window_->tabifyDockWidget(dock("techniqueDock"), dock("errorDock"));
    QVERIFY(showsTheFrame(viewport()));
  }

  void whatQtPaintsLiesOverThePicture() {
    QVERIFY(showsTheFrame(viewport()));
    viewport().setRegions({{"", 0.25f, 0.25f, 0.5f, 0.5f}});
    QVERIFY(pixelComes(viewport(), {kWidth + 40, kHeight}, qRgb(255, 221, 85)));
    viewport().setRegions({});
    QVERIFY(showsTheFrame(viewport()));
    ShownComparison wipe;
    wipe.mode = CompareMode::WipeAcross;
    wipe.pictures.a = QImage(kWidth, kHeight, QImage::Format_RGB32), wipe.pictures.b = wipe.pictures.a;
    wipe.pictures.a.fill(qRgb(10, 200, 30)), wipe.pictures.b.fill(qRgb(200, 20, 90));
    viewport().setComparison(wipe);
    QVERIFY(pixelComes(viewport(), {20, 40}, qRgb(10, 200, 30)));
    QVERIFY(pixelComes(viewport(), {viewport().width() - 20, 40}, qRgb(200, 20, 90)));
    viewport().setComparison({});
    QVERIFY(showsTheFrame(viewport()));
  }

  void zoomEnlargesThePicture() {
    const auto frame = settledFrame();
    QVERIFY(frame);
    for (int i = 0; i < 5; ++i) viewport().zoomIn();
    const QRectF r = viewport().pictureRect();
    QVERIFY(r.width() > 2.9 * viewport().width());
    // Each pixel of the lower half (the label is above) is that of the frame under it; at an edge between two, either.
    const auto right = [&] {
      const QImage screen = onScreen(viewport());
      const auto f = link_->latest();
      if (f->display.empty()) return false;
      for (int y = screen.height() / 2; y < screen.height(); ++y)
        for (int x = 0; x < screen.width(); ++x) {
          bool one = false;
          for (const double dx : {-0.02, 0.02})
            for (const double dy : {-0.02, 0.02}) {
              const int px = static_cast<int>((x + 0.5 - std::round(r.x())) / r.width() * f->width + dx), py = static_cast<int>((y + 0.5 - std::round(r.y())) / r.height() * f->height + dy);
              const unsigned char* p = &f->display[static_cast<size_t>(py * f->width + px) * 4];
              one = one || screen.pixel(x, y) == qRgb(p[0], p[1], p[2]);
            }
          if (!one) return false;
        }
      return true;
    };
    QVERIFY(QTest::qWaitFor(right, 60000));
    viewport().zoomToFit();
    QVERIFY(showsTheFrame(viewport()));
  }

  void aHiddenWindowIsNotDrawn() {
    QVERIFY(showsTheFrame(viewport()));
    window_->hide();  // unmapped, as a window manager does when it minimises
    const auto quiet = [&] {
      const uint64_t before = presenter_->report().presented;
      return anotherFrame() && presenter_->report().presented == before;
    };
    QVERIFY(QTest::qWaitFor(quiet, kLongest));
    window_->show();
    QVERIFY(showsTheFrame(viewport()));
  }

  void droppedFilesAreShownOrRefused() {
    Preset other = smallPreset();
    other.scene = "furnace_box_050";
    other.display.exposure = -1;
    savePreset(other, folder_.filePath("other.json").toStdString());
    drop(folder_.filePath("other.json"));
    QVERIFY(QTest::qWaitFor([&] { return link_->latest()->preset.scene == "furnace_box_050"; }, kLongest));
    QVERIFY(showsTheFrame(viewport()));
    QFile broken(folder_.filePath("broken.json"));
    QVERIFY(broken.open(QIODevice::WriteOnly));
    broken.write("{\"version\": 1, \"scene\": ");
    broken.close();
    const QImage before = onScreen(viewport());
    drop(broken.fileName());
    QVERIFY(QTest::qWaitFor([&] { return window_->noticeText().contains("broken.json"); }, kLongest));
    // The notice is over the picture, and the picture where it was.
    QVERIFY(QTest::qWaitFor([&] { return onScreen(viewport()) != before; }, kLongest));
    QCOMPARE(onScreen(viewport()).copy(0, 0, viewport().width(), 60), before.copy(0, 0, viewport().width(), 60));
    QCOMPARE(link_->latest()->preset.scene, std::string("furnace_box_050"));
    viewport().setNotice({});
    drop(folder_.filePath("small.json"));
    QVERIFY(QTest::qWaitFor([&] { return link_->latest()->preset.scene == smallPreset().scene; }, kLongest));
    QVERIFY(showsTheFrame(viewport()));
  }

  void theSurfaceMayGoAndComeBack() {
    QVERIFY(showsTheFrame(viewport()));
    QWindow* native = viewport().swapchainView()->window();
    native->destroy();
    QVERIFY(!viewport().swapchainView()->isShown());
    native->show();
    QVERIFY(showsTheFrame(viewport()));
  }

  void theMenuChangesThePresenter() {
    window_->setPresenterWish(PresenterWish::ReadBack);
    QVERIFY(!viewport().swapchainView());
    QVERIFY(!presenter_->attached());
    const auto frame = settledFrame();
    QVERIFY(frame);
    QVERIFY(QTest::qWaitFor([&] { return wrongPixels(viewport(), *link_->latest()) == 0; }, 60000));
    window_->setPresenterWish(PresenterWish::Swapchain);
    QVERIFY(showsTheFrame(viewport()));
  }

  void aLostDeviceIsToldAndStartedAgain() {
    QVERIFY(showsTheFrame(viewport()));
    presenter_.reset();
    emit link_->failed("the device was lost", ErrorKind::Device);
    QVERIFY(!viewport().swapchainView());
    QCOMPARE(window_->noticeText(), QString("the device was lost"));
    QToolButton* again = nullptr;
    for (QToolButton* b : window_->findChildren<QToolButton*>())
      if (b->text() == QLatin1String("Start the engine again")) again = b;
    QVERIFY(again && !again->isHidden());
    again->click();
    QVERIFY(QTest::qWaitFor([&] { return presenter_ && link_->latest(); }, kLongest));
    QVERIFY(showsTheFrame(viewport()));
  }

  /// A viewport that is a dock itself: Qt takes its window from parent to parent.
  void theViewportAsADock() {
    window_->close();
    window_.reset();
    listen();
    QVERIFY(!presenter_->attached());
    QMainWindow host;
    host.resize(1200, 800);
    host.setCentralWidget(new QLabel("middle"));
    auto* dock = new QDockWidget("Picture");
    auto* other = new QDockWidget("Other");
    auto* view = new Viewport;
    view->setFixedSize(4 * kWidth, 4 * kHeight);
    dock->setWidget(view);
    other->setWidget(new QLabel("other"));
    host.addDockWidget(Qt::LeftDockWidgetArea, dock);
    host.addDockWidget(Qt::RightDockWidgetArea, other);
    connect(link_.get(), &EngineLink::frameReady, view, [&] { view->showFrame(link_->latest()); });
    view->usePresenter(presenter_);
    host.show();
    QVERIFY(anotherFrame());
    QVERIFY(showsTheFrame(*view));
    dock->setFloating(true);
    QVERIFY(showsTheFrame(*view));
    dock->move(300, 200);
    QVERIFY(showsTheFrame(*view));
    dock->setFloating(false);
    QVERIFY(showsTheFrame(*view));

    host.tabifyDockWidget(dock, other);
    other->raise();
    const auto quiet = [&] {
      const uint64_t before = presenter_->report().presented;
      return anotherFrame() && presenter_->report().presented == before;
    };
    QVERIFY(QTest::qWaitFor(quiet, kLongest));
    hl::Display darker = smallPreset().display;
    darker.exposure = -2;
    link_->setDisplay(darker);
    QVERIFY(QTest::qWaitFor([&] { return link_->latest()->preset.display == darker; }, kLongest));
    QVERIFY(quiet());
    dock->raise();
    QVERIFY(showsTheFrame(*view));
    dock->close();
    QVERIFY(QTest::qWaitFor(quiet, kLongest));
    dock->show();
    dock->raise();
    QVERIFY(showsTheFrame(*view));

    // The engine goes first: the window still has its surface, and nothing is drawn there any more.
    link_->restart();
    QVERIFY(view->swapchainView());
    view->usePresenter(nullptr);
    QVERIFY(!view->swapchainView());
  }
};

}  // namespace

QTEST_MAIN(SwapchainTest)
#include "swapchain_test.moc"
