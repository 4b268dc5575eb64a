// The window without an engine behind it: layout, colours, drops, frames that arrive, keys.
#include <QDockWidget>
#include <QLabel>
#include <QMimeData>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <QUrl>

#include "fake_link.h"
#include "ui/main_window.h"
#include "ui/parameter_panel.h"
#include "ui/pass_bars.h"
#include "ui/preset_actions.h"
#include "ui/profiler_dock.h"
#include "ui/settings.h"
#include "ui/technique_dock.h"
#include "ui/viewport.h"

namespace {

using namespace hl;
using namespace hl::ui;

/// A frame of two halves, red and blue, with two passes.
std::shared_ptr<FrameResult> someFrame(uint64_t number, const Preset& preset) {
  static const auto scene = [] {
    auto s = std::make_shared<Scene>();
    s->name = "box", s->hash = "1";
    s->cameras.resize(2);
    s->cameras[0].name = "front", s->cameras[1].name = "side";
    s->bounds.extend(vec3(-1)), s->bounds.extend(vec3(1));
    return s;
  }();
  auto f = std::make_shared<FrameResult>();
  f->number = number, f->width = 64, f->height = 36;
  f->display.resize(64 * 36 * 4);
  for (size_t i = 0; i < 64 * 36; ++i) {
    f->display[i * 4 + (i % 64 < 32 ? 0 : 2)] = 255;
    f->display[i * 4 + 3] = 255;
  }
  f->lastPasses = {{"gbuffer", false, 1.5, 0, ""}, {"composite", false, 0.5, 0, ""}};
  f->passes = {{"gbuffer", "gpu", 1.5, 1.4, 1.7, 1.5, ""}, {"composite", "gpu", 0.5, 0.4, 0.6, 0.5, ""}, {"sky", "gpu", 0, 0, 0, 0, "the scene has no sky"}};
  f->scene = scene;
  f->preset = preset;
  return f;
}

class WindowTest : public QObject {
  Q_OBJECT

  QTemporaryDir folder_;
  std::unique_ptr<FakeLink> link_;
  std::unique_ptr<Settings> settings_;
  std::unique_ptr<MainWindow> window_;

  void makeWindow() {
    window_.reset();
    link_ = std::make_unique<FakeLink>();
    settings_.reset();  // after its writes
    settings_ = std::make_unique<Settings>(folder_.filePath("settings.ini"));
    window_ = std::make_unique<MainWindow>(*link_, *settings_, QString());
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    Preset p;
    p.technique = "none";
    emit link_->opened(p, {});
    link_->publish(someFrame(1, p));
  }

 private slots:
  void init() {
    QFile::remove(folder_.filePath("settings.ini"));
    makeWindow();
  }
  void cleanup() { window_.reset(), settings_.reset(), link_.reset(); }

  void docksAreNamedAndMovable() {
    QSet<QString> names;
    for (const QDockWidget* dock : window_->docks()) {
      names << dock->objectName();
      QVERIFY(dock->features() & QDockWidget::DockWidgetMovable);
      QVERIFY(dock->features() & QDockWidget::DockWidgetFloatable);
      QVERIFY(dock->features() & QDockWidget::DockWidgetClosable);
    }
    QCOMPARE(names, (QSet<QString>{"techniqueDock", "sceneDock", "probesDock", "profilerDock", "errorDock", "compareDock", "inspectorDock", "sweepDock", "logDock"}));
  }

  void theLayoutComesBack() {
    auto* log = window_->findChild<QDockWidget*>("logDock");
    auto* scene = window_->findChild<QDockWidget*>("sceneDock");
    window_->addDockWidget(Qt::LeftDockWidgetArea, scene);
    log->close();
    window_->close();
    makeWindow();
    QVERIFY(window_->findChild<QDockWidget*>("logDock")->isHidden());
    QCOMPARE(window_->dockWidgetArea(window_->findChild<QDockWidget*>("sceneDock")), Qt::LeftDockWidgetArea);
    window_->resetLayout();
    QVERIFY(!window_->findChild<QDockWidget*>("logDock")->isHidden());
    QCOMPARE(window_->dockWidgetArea(window_->findChild<QDockWidget*>("sceneDock")), Qt::RightDockWidgetArea);
  }

  void aLayoutOfAnotherVersionIsLeftAlone() {
    auto* log = window_->findChild<QDockWidget*>("logDock");
    log->close();
    settings_->setValue("layout/state/tune", window_->saveState(999));
    window_->close();
    settings_->setValue("layout/state/tune", window_->saveState(999));  // closing wrote its own
    makeWindow();
    QVERIFY(!window_->findChild<QDockWidget*>("logDock")->isHidden());
  }

  /// Each comes back as it was left, in the next run too; a reset is of the one that is shown.
  void namedLayoutsAreKeptApart() {
    const auto dock = [&](const char* name) { return window_->findChild<QDockWidget*>(name); };
    QCOMPARE(window_->dockWidgetArea(dock("compareDock")), Qt::BottomDockWidgetArea);
    window_->switchLayout("compare");
    QCOMPARE(window_->dockWidgetArea(dock("compareDock")), Qt::RightDockWidgetArea);
    dock("logDock")->close();
    window_->switchLayout("profile");
    QVERIFY(!dock("logDock")->isHidden());
    QTRY_VERIFY(dock("profilerDock")->height() > 350);
    window_->switchLayout("compare");
    QVERIFY(dock("logDock")->isHidden());
    window_->close();
    makeWindow();
    QVERIFY(dock("logDock")->isHidden());
    QCOMPARE(window_->dockWidgetArea(dock("compareDock")), Qt::RightDockWidgetArea);
    window_->resetLayout();
    QVERIFY(!dock("logDock")->isHidden());
    QTest::keyClick(window_.get(), Qt::Key_1, Qt::AltModifier);
    QCOMPARE(window_->dockWidgetArea(dock("compareDock")), Qt::BottomDockWidgetArea);
    for (const QDockWidget* d : window_->docks()) QVERIFY2(!d->isHidden() && window_->dockWidgetArea(const_cast<QDockWidget*>(d)) != Qt::NoDockWidgetArea, qPrintable(d->objectName()));
  }

  void coloursDependOnTheNameAlone() {
    PassPalette a(settings_.get());
    const QStringList names{"gbuffer", "composite", "tone map", "radiosity: gather", "direct: shadow rays", "x", "y", "z"};
    QMap<QString, QColor> first;
    for (const QString& n : names) first[n] = a.of(n.toStdString());
    QSet<QRgb> distinct;
    for (const QColor& c : first) distinct << c.rgb();
    QCOMPARE(distinct.size(), names.size());
    // Asked in the other order, in another run: the same.
    settings_.reset();
    settings_ = std::make_unique<Settings>(folder_.filePath("settings.ini"));
    PassPalette b(settings_.get());
    for (auto it = names.rbegin(); it != names.rend(); ++it) QCOMPARE(b.of(it->toStdString()), first[*it]);
    // Full: colours are shared, evenly.
    PassPalette c;
    QMap<QRgb, int> uses;
    for (int i = 0; i < 2 * PassPalette::size(); ++i) ++uses[c.of("pass " + std::to_string(i)).rgb()];
    for (const int n : uses) QCOMPARE(n, 2);
  }

  void thePictureIsShownWhole() {
    const QRectF r = window_->viewport().pictureRect();
    QVERIFY(std::abs(r.width() / r.height() - 64.0 / 36.0) < 0.01);
    const QImage shot = window_->viewport().grab().toImage();
    const double scale = shot.devicePixelRatio();
    const auto at = [&](double x, double y) { return shot.pixelColor((r.topLeft() + QPointF(r.width() * x, r.height() * y)).toPoint() * scale); };
    QCOMPARE(at(0.25, 0.5), QColor(255, 0, 0));
    QCOMPARE(at(0.75, 0.5), QColor(0, 0, 255));
    QCOMPARE(window_->viewport().pixelAt(r.center()).value().y(), 18);
    QVERIFY(!window_->viewport().pixelAt(r.topLeft() - QPointF(2, 2)));
  }

  /// A click shows where the picked point's samples went, until Escape.
  void aPickedPointsSamplesAreDrawn() {
    Viewport& viewport = window_->viewport();
    Camera camera;
    camera.position = vec3(0, 0, 4), camera.target = vec3(0), camera.verticalFov = 0.6f;
    viewport.setCamera(camera, 2);
    auto frame = someFrame(2, window_->document().preset());
    // Along the picture's middle row, to the right of its centre; the other one lies behind the camera and is not drawn.
    frame->pick.samples = {{vec3(0.02f, 0, 0), vec3(1, 0, 0), vec3(0, 2, 0), 0.5f}, {vec3(0.02f, 0, 5), vec3(-1, 0, 6), vec3(9, 9, 9), 0.5f}};
    frame->pick.facts = {{"texel", "(3, 4)"}};
    link_->publish(frame);
    const QRectF r = viewport.pictureRect();
    const auto onTheLine = [&] {
      const QImage shot = viewport.grab().toImage();
      const QPointF p = r.topLeft() + QPointF(r.width() * 0.56, r.height() * 0.5);
      int most = 0;
      for (int dy = -2; dy <= 2; ++dy) most = std::max(most, shot.pixelColor((p + QPointF(0, dy)).toPoint() * shot.devicePixelRatio()).green());
      return most;
    };
    QCOMPARE(onTheLine(), 0);  // nothing was clicked yet
    QSignalSpy picked(&viewport, &Viewport::pixelPicked);
    QTest::mouseClick(&viewport, Qt::LeftButton, {}, r.center().toPoint() - QPoint(20, 20));
    QCOMPARE(picked.count(), 1);
    QVERIFY(onTheLine() > 30);
    QTest::keyClick(&viewport, Qt::Key_Escape);
    QCOMPARE(onTheLine(), 0);
  }

  void spaceShowsTheReferenceAndKeepsTheView() {
    link_->takeCalls();
    QTest::keyPress(&window_->viewport(), Qt::Key_Space);
    QVERIFY(link_->calls.contains("reference on"));
    QVERIFY(link_->calls.last().startsWith("display reference"));
    QCOMPARE(window_->document().preset().display.view, std::string("final"));
    QTest::keyRelease(&window_->viewport(), Qt::Key_Space);
    QVERIFY(link_->calls.last().startsWith("display final"));
    QCOMPARE(window_->document().undoStack().count(), 0);
  }

  void exposureGoesByHalfStops() {
    QTest::keyClick(window_.get(), Qt::Key_E);
    QTest::keyClick(window_.get(), Qt::Key_E);
    QCOMPARE(window_->document().preset().display.exposure, 1.0f);
    QTest::keyClick(window_.get(), Qt::Key_E, Qt::ShiftModifier);
    QCOMPARE(window_->document().preset().display.exposure, 0.5f);
  }

  void camerasUnderTheDigits() {
    QTest::keyClick(&window_->viewport(), Qt::Key_2);
    QVERIFY(link_->calls.contains("camera side"));
    Camera c;
    c.position = vec3(7, 8, 9);
    window_->document().moveCamera(c);
    QTest::keyClick(&window_->viewport(), Qt::Key_5, Qt::ControlModifier);
    QTest::keyClick(&window_->viewport(), Qt::Key_1);
    QCOMPARE(window_->document().camera()->name, std::string("front"));
    QTest::keyClick(&window_->viewport(), Qt::Key_5);
    QCOMPARE(window_->document().camera()->position.z, 9.0f);
  }

  void doubleClickFocusesOnWhatIsThere() {
    const QPoint middle = window_->viewport().pictureRect().center().toPoint();
    QTest::mouseDClick(&window_->viewport(), Qt::LeftButton, {}, middle);
    const QString pick = link_->calls.filter("pick").last();
    const QStringList words = pick.split(' ');
    auto f = someFrame(2, window_->document().preset());
    f->picked.x = words[1].toInt(), f->picked.y = words[2].toInt();
    f->picked.triangle = 0;
    f->picked.position = vec3(0.5f, 0.25f, 0);
    link_->publish(f);
    QVERIFY(window_->document().preset().camera.has_value());
    QCOMPARE(window_->document().preset().camera->target.y, 0.25f);
  }

  void aDragInTheViewportOrbits() {
    const QPoint middle = window_->viewport().pictureRect().center().toPoint();
    QTest::mousePress(&window_->viewport(), Qt::LeftButton, {}, middle);
    QTest::mouseMove(&window_->viewport(), middle + QPoint(60, 0));
    QTest::mouseRelease(&window_->viewport(), Qt::LeftButton, {}, middle + QPoint(60, 0));
    QVERIFY(window_->document().preset().camera.has_value());
    QVERIFY(!link_->calls.join(' ').contains("pick"));  // a drag is no click
  }

  void droppedFilesGoToTheEngine() {
    QMimeData file;
    file.setUrls({QUrl::fromLocalFile("/some/where.txt")});
    QVERIFY(PresetActions::acceptable(file));
    QDragEnterEvent enter(QPoint(10, 10), Qt::CopyAction, &file, Qt::LeftButton, Qt::NoModifier);
    QCoreApplication::sendEvent(window_.get(), &enter);
    QVERIFY(enter.isAccepted());
    QDropEvent drop(QPointF(10, 10), Qt::CopyAction, &file, Qt::LeftButton, Qt::NoModifier);
    QCoreApplication::sendEvent(window_.get(), &drop);
    QVERIFY(link_->calls.contains("open /some/where.txt"));
    QMimeData words;
    words.setText("hello");
    QVERIFY(!PresetActions::acceptable(words));
  }

  void anErrorIsShownAndNothingIsLost() {
    window_->document().editSeed(7);
    emit link_->failed("that.txt: not a preset", ErrorKind::BadInput);
    QCOMPARE(window_->noticeText(), QString("that.txt: not a preset"));
    QCOMPARE(window_->document().preset().seed, 7u);
    QVERIFY(window_->windowTitle().contains("[*]") && window_->isWindowModified());
  }

  /// Nobody sees its frames; but a bake is what people minimise a window for.
  void aMinimisedWindowStopsFramesAndNoWork() {
    link_->takeCalls();
    window_->showMinimized();
    QTRY_VERIFY(link_->calls.contains("hidden"));
    QVERIFY(!link_->calls.contains("visible"));
    window_->showNormal();
    QTRY_VERIFY(link_->calls.contains("visible"));
    for (const QString& call : link_->takeCalls()) QVERIFY2(call == "hidden" || call == "visible", qPrintable(call));
  }

  void profilerCountsFramesOnce() {
    auto* profiler = window_->findChild<ProfilerPanel*>();
    const size_t before = profiler->bars().frames();
    link_->publish(someFrame(2, window_->document().preset()));
    link_->publish(someFrame(2, window_->document().preset()));
    link_->publish(someFrame(3, window_->document().preset()));
    QCOMPARE(profiler->bars().frames(), before + 2);
  }

  void skippedPassesSayWhy() {
    QTest::qWait(250);
    auto* table = window_->findChild<PassTable*>();
    QStringList texts;
    for (int r = 0; r < table->model()->rowCount(); ++r) texts << table->model()->index(r, PassModel::Skipped).data().toString();
    QVERIFY(texts.contains("the scene has no sky"));
  }
};

}  // namespace

QTEST_MAIN(WindowTest)
#include "window_test.moc"
