// Probes by hand: dragged, added and deleted in the viewport and by number, each a step of undo, and kept in the preset. Without an engine behind it.
#include <QApplication>
#include <QDockWidget>
#include <QLabel>
#include <QMouseEvent>
#include <QPushButton>
#include <QTableWidget>
#include <QTest>
#include <cmath>

#include "fake_window.h"
#include "ui/probe_tool.h"
#include "ui/probes_panel.h"
#include "ui/viewport.h"

namespace {

using namespace hl;
using namespace hl::ui;

constexpr int kWidth = 160, kHeight = 90;

class ProbesTest : public FakeWindowTest {
  Q_OBJECT

  std::shared_ptr<Scene> scene_;
  std::shared_ptr<PlacedProbes> placed_;
  uint64_t number_ = 0;
  Camera camera_;

  Viewport& viewport() { return window_->viewport(); }
  Document& document() { return window_->document(); }
  ProbesPanel* panel() { return window_->findChild<ProbesPanel*>(); }
  QTableWidget* table() { return panel()->findChild<QTableWidget*>(); }
  QString facts() { return panel()->findChild<QLabel*>()->text(); }
  QPushButton* button(const char* text) {
    for (QPushButton* b : panel()->findChildren<QPushButton*>())
      if (b->text().remove('&') == text) return b;
    return nullptr;
  }

  /// As the engine would: by hand those of the document, else two of a grid; one inside geometry where its y is below -0.9.
  void publish() {
    const bool byHand = document().parameter("probes.placement") == "manual";
    placed_ = std::make_shared<PlacedProbes>();
    placed_->positions = byHand ? document().probes() : std::vector<vec3>{{-0.5f, 0, 0}, {0.5f, 0, 0}};
    placed_->coverage = 0.1 * static_cast<double>(placed_->count()), placed_->candidates = placed_->count();
    for (const vec3 p : placed_->positions) placed_->inside.push_back(p.y < -0.9f), placed_->insideGeometry += p.y < -0.9f;
    if (placed_->insideGeometry) placed_->warnings = {"probes: 1 of 3 manual ones stands inside geometry"};
    auto f = std::make_shared<FrameResult>();
    f->number = ++number_, f->width = kWidth, f->height = kHeight;
    f->display.resize(static_cast<size_t>(kWidth) * kHeight * 4, 40);
    f->camera = camera_, f->scene = scene_, f->probes = placed_;
    f->preset = document().preset();
    f->atlas.area = 200;
    const QStringList words = link_->calls.filter("pick").isEmpty() ? QStringList() : link_->calls.filter("pick").last().split(' ');
    if (words.size() == 3) {
      f->picked.x = words[1].toInt(), f->picked.y = words[2].toInt(), f->picked.triangle = 17;
      f->picked.position = vec3(0.25f, -1, 0.5f), f->picked.normal = vec3(0, 1, 0);
    }
    link_->publish(f);
    QTest::qWait(150);  // panels are refreshed ten times a second
  }
  QPoint inWidget(vec3 p) {
    const CameraBasis b = cameraBasis(camera_, static_cast<float>(kWidth) / kHeight);
    const vec3 to = p - b.origin;
    const float ahead = glm::dot(to, b.forward);
    const float x = glm::dot(to, b.right) / glm::dot(b.right, b.right) / ahead, y = glm::dot(to, b.down) / glm::dot(b.down, b.down) / ahead;
    const QRectF r = viewport().pictureRect();
    return (r.topLeft() + QPointF(r.width() * 0.5 * (1 + static_cast<double>(x)), r.height() * 0.5 * (1 + static_cast<double>(y)))).toPoint();
  }
  void drag(vec3 from, vec3 to, Qt::KeyboardModifiers modifiers) {
    const QPoint a = inWidget(from), b = inWidget(to);
    QTest::mousePress(&viewport(), Qt::LeftButton, modifiers, a);
    for (const QPoint p : {(a + b) / 2, b}) {
      QMouseEvent move(QEvent::MouseMove, QPointF(p), viewport().mapToGlobal(QPointF(p)), Qt::NoButton, Qt::LeftButton, modifiers);
      QApplication::sendEvent(&viewport(), &move);
    }
    QTest::mouseRelease(&viewport(), Qt::LeftButton, modifiers, b);
  }
  static bool near(vec3 a, vec3 b) { return glm::length(a - b) < 0.02f; }

 private slots:
  void init() {
    camera_.position = vec3(0, 0, 4), camera_.target = vec3(0.0f), camera_.verticalFov = 0.8f;
    scene_ = std::make_shared<Scene>();
    scene_->name = "box", scene_->hash = "1";
    scene_->cameras = {camera_};
    scene_->probes = {{0, 0.5f, 0}};
    scene_->bounds.extend(vec3(-1)), scene_->bounds.extend(vec3(1));
    openWindow();
    Preset p;
    p.technique = "none";
    p.width = kWidth, p.height = kHeight;
    emit link_->opened(p, {});
    publish();
    link_->takeCalls();
  }
  void cleanup() { closeWindow(); }

  void countAndCoverageAreShown() {
    QVERIFY2(facts().startsWith("2 probes see 20.0 %"), qPrintable(facts()));
    QVERIFY2(facts().contains("Seen by none: 160 m²"), qPrintable(facts()));
    QCOMPARE(table()->rowCount(), 2);
  }

  void takingUpTheToolMakesPlacedProbesOnesOwnAndUndoGivesThemBack() {
    QTest::keyClick(&viewport(), Qt::Key_H);
    QVERIFY(viewport().probeTool().active() && button("Edit by hand")->isChecked());
    QCOMPARE(document().parameter("probes.placement"), std::string("manual"));
    QCOMPARE(document().probes(), placed_->positions);
    const QStringList calls = link_->takeCalls();
    QVERIFY(calls.contains("probes 2") && calls.contains("param probes.placement=manual"));
    QVERIFY(calls.indexOf("probes 2") < calls.indexOf("param probes.placement=manual"));
    document().undoStack().undo();
    QCOMPARE(document().parameter("probes.placement"), std::string("grid"));
    QVERIFY(!document().preset().probes);
    QVERIFY(link_->calls.contains("probes of the scene"));
    QTest::keyClick(&viewport(), Qt::Key_Escape);
    QVERIFY(!viewport().probeTool().active());
  }

  void draggedParallelToThePictureAndAlongAxes() {
    QTest::keyClick(&viewport(), Qt::Key_H);
    publish();
    drag({-0.5f, 0, 0}, {-0.2f, 0.4f, 0}, {});
    QVERIFY(near(document().probes()[0], {-0.2f, 0.4f, 0}));
    QVERIFY(near(document().probes()[1], {0.5f, 0, 0}));
    QVERIFY(!document().preset().camera);  // the camera stays
    publish();
    drag({-0.2f, 0.4f, 0}, {0.3f, 0.1f, 0}, Qt::ShiftModifier);
    QVERIFY(near(document().probes()[0], {-0.2f, 0.1f, 0}));
    publish();
    drag({-0.2f, 0.1f, 0}, {0.3f, 0.7f, 0}, Qt::ControlModifier);
    QVERIFY(near(document().probes()[0], {0.3f, 0.1f, 0}));
    document().undoStack().undo();
    document().undoStack().undo();
    QVERIFY(near(document().probes()[0], {-0.2f, 0.4f, 0}));
    document().undoStack().redo();
    QVERIFY(near(document().probes()[0], {-0.2f, 0.1f, 0}));
    // From the side, along z.
    camera_.position = vec3(4, 0, 0);
    publish();
    const vec3 before = document().probes()[0];
    drag(before, before + vec3(0, 0, 0.5f), Qt::AltModifier);
    QVERIFY(near(document().probes()[0], before + vec3(0, 0, 0.5f)));
  }

  void aClickOnASurfaceAddsOneInFrontAndDeleteTakesItAway() {
    QTest::keyClick(&viewport(), Qt::Key_H);
    publish();
    QTest::mouseClick(&viewport(), Qt::LeftButton, {}, inWidget({0.25f, -1, 0.5f}));
    QVERIFY(!link_->calls.filter("pick").isEmpty());
    publish();  // the session's answer
    QCOMPARE(document().probes().size(), size_t(3));
    QVERIFY(near(document().probes()[2], {0.25f, -0.9f, 0.5f}));
    QCOMPARE(viewport().probeTool().selected(), std::optional<size_t>(2));
    link_->takeCalls();
    publish();
    QVERIFY2(facts().startsWith("3 probes see 30.0 %"), qPrintable(facts()));  // a person sees the change
    QTest::keyClick(&viewport(), Qt::Key_Delete);
    QCOMPARE(document().probes().size(), size_t(2));
    document().undoStack().undo();
    QCOMPARE(document().probes().size(), size_t(3));
  }

  void byNumberAtTheCameraAndInsideGeometry() {
    button("Add at camera")->click();
    QCOMPARE(document().probes().size(), size_t(3));
    QVERIFY(near(document().probes()[2], camera_.position));
    publish();
    QCOMPARE(table()->rowCount(), 3);
    table()->item(2, 1)->setText("-0.95");
    QVERIFY(near(document().probes()[2], {0, -0.95f, 4}));
    publish();
    QVERIFY2(facts().contains("inside geometry"), qPrintable(facts()));
    QCOMPARE(table()->item(2, 0)->toolTip(), QString("Inside geometry"));
    for (const char* text : {"", "far", "1e30", "nan"}) {
      const auto before = document().probes();
      table()->item(0, 0)->setText(text);
      QVERIFY2(document().probes() == before, text);
      QCOMPARE(table()->item(0, 0)->text(), QString("-0.5"));
    }
    table()->setCurrentCell(2, 0);
    button("Delete")->click();
    QCOMPARE(document().probes().size(), size_t(2));
    button("The scene's own")->click();
    QVERIFY(!document().preset().probes);
    QCOMPARE(document().probes(), scene_->probes);
  }

  void probesAreSeenInThePicture() {
    const QImage before = viewport().grab().toImage();
    QTest::keyClick(&viewport(), Qt::Key_H);
    publish();
    const QImage after = viewport().grab().toImage();
    const QPoint at = inWidget({0.5f, 0, 0});
    QVERIFY(before.pixelColor(at * before.devicePixelRatio()) != after.pixelColor(at * after.devicePixelRatio()));
    if (const QByteArray folder = qgetenv("HALFLIGHT_TEST_PICTURES"); !folder.isEmpty()) window_->grab().save(QString::fromLocal8Bit(folder) + "/probes_window.png");
  }

  void probesAreKeptInThePreset() {
    Preset p;
    p.probes = std::vector<vec3>{{1, 2, 3}, {-0.25f, 0, 1e-3f}};
    p.parameters["probes.placement"] = "manual";
    const Preset back = presetFromJson(presetJson(p), "text");
    QVERIFY(back.probes == p.probes);
    QVERIFY(presetHash(p) != presetHash(Preset{}));
    for (const char* bad : {"[[1, 2]]", "[[1, 2, \"a\"]]", "3", "[[1, 2, 1e30]]"})
      QVERIFY_EXCEPTION_THROWN(presetFromJson(std::string("{\"version\": 1, \"scene\": \"cornell_box\", \"probes\": ") + bad + "}", "text"), Error);
  }
};

}  // namespace

QTEST_MAIN(ProbesTest)
#include "probes_test.moc"
