// Comparing pictures in the viewport: every mode, snapshots, and what is said where there is nothing to compare. Without an engine behind it.
#include <QComboBox>
#include <QDockWidget>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QSignalSpy>
#include <QSlider>
#include <QTest>
#include <QWheelEvent>
#include <cmath>

#include "engine/metrics/metrics.h"
#include "fake_window.h"
#include "ui/compare_dock.h"
#include "ui/viewport.h"

namespace {

using namespace hl;
using namespace hl::ui;

constexpr int kWidth = 64, kHeight = 36;

std::shared_ptr<const Image> plain(vec3 colour, int width = kWidth, int height = kHeight) {
  auto image = std::make_shared<Image>(width, height, 3);
  for (size_t i = 0; i < image->pixels(); ++i)
    for (int c = 0; c < 3; ++c) image->data[i * 3 + static_cast<size_t>(c)] = colour[c];
  return image;
}

class CompareTest : public FakeWindowTest {
  Q_OBJECT

  uint64_t number_ = 0;
  bool glossy_ = false;  ///< the scene, and the left half of the picture

  static Mask leftHalf() {
    Mask mask(static_cast<size_t>(kWidth) * kHeight, 0);
    for (size_t i = 0; i < mask.size(); ++i) mask[i] = i % kWidth < kWidth / 2;
    return mask;
  }
  QComboBox* parts() {
    for (QComboBox* box : panel()->findChildren<QComboBox*>())
      if (box->accessibleName() == "Of") return box;
    return nullptr;
  }

  Compare& compare() { return window_->compare(); }
  Viewport& viewport() { return window_->viewport(); }
  ComparePanel* panel() { return window_->findChild<ComparePanel*>(); }

  /// What the engine would publish: the images that are wanted, of those it has.
  void publish(std::map<std::string, std::shared_ptr<const Image>> images, const Preset* preset = nullptr) {
    auto f = std::make_shared<FrameResult>();
    f->features.glossySurfaces = glossy_;
    if (glossy_) f->surfaces = std::make_shared<Mask>(static_cast<size_t>(kWidth) * kHeight, 1), f->glossy = std::make_shared<Mask>(leftHalf());
    f->number = ++number_, f->width = kWidth, f->height = kHeight;
    f->display.resize(static_cast<size_t>(kWidth) * kHeight * 4, 10);
    for (const std::string& name : link_->wanted)
      if (images.count(name)) f->images[name] = images[name];
    f->preset = preset ? *preset : window_->document().preset();
    f->workMs = 1234;
    ErrorValue e;
    e.reference = "matched", e.target = "image", e.component = "indirect", e.metric = "relmse", e.value = 0.125;
    f->errors = {e};
    link_->publish(f);
  }
  void choose(CompareMode mode, const QString& a = "live", const QString& b = "full") {
    CompareChoice c = compare().choice();
    c.mode = mode, c.a = a, c.b = b;
    compare().choose(c);
  }
  /// A comparison of two plain pictures, as soon as it is on the screen.
  void show(CompareMode mode, vec3 a, vec3 b) {
    choose(mode);
    QSignalSpy made(&compare(), &Compare::picturesChanged);
    publish({{"final", plain(a)}, {"reference", plain(b)}});
    // The pictures of what was just published, not those of before: the last of them has come when no more follow.
    QVERIFY(QTest::qWaitFor([&] { return made.count() > 0 && !compare().pictures().a.isNull() && compare().pictures().mode == mode; }));
    for (qsizetype before = 0; before != made.count();) before = made.count(), QTest::qWait(30);
  }
  QColor seen(double x, double y) {
    const QImage shot = viewport().grab().toImage();
    const QRectF r(viewport().rect());
    return shot.pixelColor((QPointF(r.width() * x, r.height() * y) * shot.devicePixelRatio()).toPoint());
  }
  QColor toneMapped(vec3 colour) {
    const auto bytes = toneMapOnHost(*plain(colour, 1, 1), window_->document().preset().display);
    return QColor(bytes[0], bytes[1], bytes[2]);
  }

 private slots:
  void init() {
    glossy_ = false;
    openWindow();
    Preset p;
    p.technique = "none";
    emit link_->opened(p, {});
    publish({});
  }
  void cleanup() { closeWindow(); }

  void theEngineIsAskedForWhatIsComparedAndNoMore() {
    QVERIFY(link_->wanted.empty());
    choose(CompareMode::WipeAcross, "live", "matched");
    QCOMPARE(link_->wanted, (std::vector<std::string>{"final", "reference_matched"}));
    QVERIFY(link_->calls.contains("reference on"));
    CompareChoice c = compare().choice();
    c.part = PicturePart::Indirect;
    compare().choose(c);
    QCOMPARE(link_->wanted, (std::vector<std::string>{"indirect_irradiance", "reference_matched_indirect"}));
    choose(CompareMode::Off);
    QVERIFY(link_->wanted.empty());
  }

  void aWipeShowsAOnOneSideAndBOnTheOther() {
    const vec3 a(0.2f, 0.1f, 0.05f), b(0.05f, 0.3f, 0.6f);
    show(CompareMode::WipeAcross, a, b);
    QCOMPARE(seen(0.4, 0.5), toneMapped(a));
    QCOMPARE(seen(0.6, 0.5), toneMapped(b));
    show(CompareMode::WipeDown, a, b);
    QCOMPARE(seen(0.5, 0.4), toneMapped(a));
    QCOMPARE(seen(0.5, 0.6), toneMapped(b));
    // The same exposure and tone map for both.
    const QColor before = toneMapped(a);
    hl::Display d = window_->document().preset().display;
    d.exposure = 1, d.toneMap = ToneMap::Aces;
    window_->document().editDisplay(d, "display");
    QVERIFY(toneMapped(a) != before);
    QTRY_COMPARE(seen(0.5, 0.4), toneMapped(a));
    QCOMPARE(seen(0.5, 0.6), toneMapped(b));
    compare().swap();
    QTRY_COMPARE(seen(0.5, 0.4), toneMapped(b));
    choose(CompareMode::Off);
    QCOMPARE(seen(0.5, 0.4), QColor(10, 10, 10));
  }

  void theLineGoesWithPointerArrowsAndSlider() {
    const vec3 a(0.2f), b(0.6f);
    show(CompareMode::WipeAcross, a, b);
    const QPoint middle = viewport().rect().center();
    QSignalSpy camera(&viewport(), &Viewport::cameraMoved), picked(&viewport(), &Viewport::pixelPicked);
    QTest::mousePress(&viewport(), Qt::LeftButton, {}, middle + QPoint(2, 30));
    QTest::mouseMove(&viewport(), middle + QPoint(viewport().width() / 4, 30));
    QTest::mouseRelease(&viewport(), Qt::LeftButton, {}, middle + QPoint(viewport().width() / 4, 30));
    QVERIFY(compare().choice().wipe > 0.6);
    QCOMPARE(seen(0.6, 0.5), toneMapped(a));
    QCOMPARE(camera.size() + picked.size(), 0);  // taken by the line, not by the camera
    const double before = compare().choice().wipe;
    viewport().setFocus();
    QTest::keyClick(&viewport(), Qt::Key_Left);
    QVERIFY(compare().choice().wipe < before);
    QTest::keyClick(&viewport(), Qt::Key_Up);  // not along its way
    QCOMPARE(compare().choice().wipe, before - 0.02);
    auto* slider = panel()->findChildren<QSlider*>().front();
    QVERIFY(slider->accessibleName() == "Line");
    slider->setValue(100);
    QCOMPARE(compare().choice().wipe, 0.1);
    QCOMPARE(seen(0.4, 0.5), toneMapped(b));
    show(CompareMode::WipeDown, a, b);
    QTest::keyClick(&viewport(), Qt::Key_Down, Qt::ShiftModifier);
    QVERIFY(std::abs(compare().choice().wipe - 0.102) < 1e-9);
  }

  void flickerShowsThemInTurn() {
    const vec3 a(0.2f), b(0.6f);
    CompareChoice c = compare().choice();
    c.flickerHz = 10;
    compare().choose(c);
    show(CompareMode::Flicker, a, b);
    QTRY_COMPARE(seen(0.5, 0.5), toneMapped(a));
    QTRY_COMPARE(seen(0.5, 0.5), toneMapped(b));
    QTRY_COMPARE(seen(0.5, 0.5), toneMapped(a));
    c = compare().choice();
    c.flickerHz = 1000;
    compare().choose(c);
    QCOMPARE(compare().choice().flickerHz, Compare::kMostHz);
  }

  /// Left and right show the same part of both pictures, wherever it is zoomed and moved.
  void sideBySideIsLinked() {
    auto half = [](vec3 left, vec3 right) {
      auto image = std::make_shared<Image>(kWidth, kHeight, 3);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          for (int k = 0; k < 3; ++k) image->pixel(x, y)[k] = (x < kWidth / 2 ? left : right)[k];
      return std::shared_ptr<const Image>(image);
    };
    const vec3 colours[] = {vec3(0.1f), vec3(0.3f), vec3(0.5f), vec3(0.8f)};
    choose(CompareMode::SideBySide);
    publish({{"final", half(colours[0], colours[1])}, {"reference", half(colours[2], colours[3])}});
    QTRY_VERIFY(!compare().pictures().b.isNull());
    QTRY_COMPARE(seen(0.15, 0.5), toneMapped(colours[0]));
    QCOMPARE(seen(0.35, 0.5), toneMapped(colours[1]));
    QCOMPARE(seen(0.65, 0.5), toneMapped(colours[2]));
    QCOMPARE(seen(0.85, 0.5), toneMapped(colours[3]));
    const QPoint inRight(viewport().width() * 85 / 100, viewport().height() / 2);
    const auto atPointer = viewport().pixelAt(inRight);
    QVERIFY(atPointer && atPointer->x() > kWidth / 2);
    // Zoomed in on the right picture's right half: both show their right halves, and the pixel under the pointer stays.
    for (int i = 0; i < 8; ++i) {
      QWheelEvent wheel(inRight, viewport().mapToGlobal(inRight), {}, {0, 120}, Qt::NoButton, Qt::ControlModifier, Qt::NoScrollPhase, false);
      QCoreApplication::sendEvent(&viewport(), &wheel);
    }
    QCOMPARE(viewport().pixelAt(inRight)->x(), atPointer->x());
    for (const double x : {0.05, 0.45}) QCOMPARE(seen(x, 0.45), toneMapped(colours[1]));
    for (const double x : {0.55, 0.95}) QCOMPARE(seen(x, 0.45), toneMapped(colours[3]));
    // Moved back by keys, then the whole again.
    viewport().setFocus();
    for (int i = 0; i < 60; ++i) QTest::keyClick(&viewport(), Qt::Key_Left, Qt::ControlModifier);
    QCOMPARE(seen(0.3, 0.45), toneMapped(colours[0]));
    QCOMPARE(seen(0.8, 0.45), toneMapped(colours[2]));
    QTest::keyClick(window_.get(), Qt::Key_0, Qt::ControlModifier);
    QCOMPARE(seen(0.35, 0.5), toneMapped(colours[1]));
  }

  void theDifferenceHasASignAndAGain() {
    CompareChoice c = compare().choice();
    c.gain = 1;
    compare().choose(c);
    const auto colourOf = [&](float a, float b) {
      show(CompareMode::Difference, vec3(a), vec3(b));
      return seen(0.5, 0.5);
    };
    const QColor none = colourOf(0.4f, 0.4f);
    QVERIFY(none.red() == none.green() && none.green() == none.blue());
    const QColor brighter = colourOf(0.5f, 0.4f);
    QVERIFY(brighter.red() > brighter.blue());
    QVERIFY(none.lightness() > brighter.lightness());
    // Ten times the difference is as a difference ten times as large.
    c = compare().choice();
    c.gain = 10;
    compare().choose(c);
    QTRY_VERIFY(seen(0.5, 0.5) != brighter);
    const QColor tenfold = seen(0.5, 0.5);
    c.gain = 1;
    compare().choose(c);
    QCOMPARE(colourOf(1.4f, 0.4f), tenfold);
    const QColor darker = colourOf(0.3f, 0.4f);
    QVERIFY(darker.blue() > darker.red());
    c.gain = 99;
    compare().choose(c);
    QCOMPARE(compare().choice().gain, 10.0);
  }

  void anErrorMapOfEachMetric() {
    choose(CompareMode::ErrorMap);
    auto a = std::make_shared<Image>(*plain(vec3(0.5f)));
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth / 2; ++x) a->pixel(x, y)[0] = 0.9f;  // wrong on the left
    publish({{"final", a}, {"reference", plain(vec3(0.5f))}});
    auto* metrics = panel()->findChildren<QComboBox*>().back();
    QVERIFY(metrics->count() >= 7);
    for (int i = 0; i < metrics->count(); ++i) {
      CompareChoice c = compare().choice();
      c.metric = metrics->itemData(i).toString();
      QSignalSpy made(&compare(), &Compare::picturesChanged);
      const bool another = !(c == compare().choice());
      compare().choose(c);
      if (another) QTRY_VERIFY(made.size() > 0);
      QTRY_VERIFY2(!compare().pictures().a.isNull(), qPrintable(c.metric + ": " + compare().pictures().refused));
      QVERIFY2(compare().pictures().high.startsWith(c.metric), qPrintable(compare().pictures().high));
      QVERIFY2(seen(0.25, 0.45) != seen(0.75, 0.45), qPrintable(c.metric));
      // As the metric itself makes it.
      const Image map = measure(c.metric.toStdString(), *a, ReferenceImage{*plain(vec3(0.5f)), {}, {}}, howShown(window_->document().preset().display, true)).map;
      QVERIFY(std::abs(map.pixel(2, 10)[0]) != std::abs(map.pixel(kWidth - 2, 10)[0]));
    }
  }

  void whatCannotBeComparedIsSaid() {
    choose(CompareMode::WipeAcross, "live", "full");
    publish({{"final", plain(vec3(0.5f))}});
    QTRY_VERIFY(compare().pictures().refused.contains("Full reference"));
    QCOMPARE(seen(0.5, 0.5), QColor(10, 10, 10));  // the picture itself stays
    choose(CompareMode::Difference);
    publish({{"final", plain(vec3(0.5f))}, {"reference", plain(vec3(0.5f), 10, 10)}});
    QTRY_VERIFY2(compare().pictures().refused.contains("10"), qPrintable(compare().pictures().refused));
    bool said = false;
    for (const QLabel* l : panel()->findChildren<QLabel*>()) said |= l->text() == compare().pictures().refused;
    QVERIFY(said);
  }

  void snapshotsKeepPictureAndPreset() {
    Document& d = window_->document();
    d.editSeed(4);
    compare().takeSnapshot();
    QCOMPARE(compare().snapshots().all().size(), size_t(0));
    publish({{"final", plain(vec3(0.25f))}, {"indirect_irradiance", plain(vec3(0.5f))}});
    QCOMPARE(compare().snapshots().all().size(), size_t(1));
    QVERIFY(link_->wanted.empty());  // no longer
    auto* list = panel()->findChild<QListWidget*>();
    QCOMPARE(list->count(), 1);
    QTRY_VERIFY(!list->item(0)->icon().isNull());
    QCOMPARE(list->currentRow(), 0);
    bool facts = false;
    for (const QLabel* l : panel()->findChildren<QLabel*>()) facts |= l->text().contains("0.125") && l->text().contains("1.2 s");
    QVERIFY(facts);
    const int id = compare().snapshots().all()[0].id;
    list->item(0)->setText("before");
    QCOMPARE(compare().nameOf("snapshot " + QString::number(id)), QString("before"));
    list->item(0)->setText("  ");
    QCOMPARE(compare().nameOf("snapshot " + QString::number(id)), QString("before"));

    // Live goes on; the snapshot stays.
    d.editSeed(5);
    Camera moved;
    moved.position = vec3(9);
    d.moveCamera(moved);
    choose(CompareMode::WipeAcross, "live", "snapshot " + QString::number(id));
    publish({{"final", plain(vec3(0.75f))}});
    QTRY_COMPARE(seen(0.25, 0.5), toneMapped(vec3(0.75f)));
    QCOMPARE(seen(0.75, 0.5), toneMapped(vec3(0.25f)));
    QVERIFY(compare().note().contains("camera"));
    CompareChoice c = compare().choice();
    c.part = PicturePart::Indirect;
    compare().choose(c);
    publish({{"indirect_irradiance", plain(vec3(0.75f))}});
    QTRY_COMPARE(seen(0.75, 0.5), toneMapped(vec3(0.5f)));

    // Its preset comes back, camera and all, in one step.
    const int steps = d.undoStack().count();
    const auto press = [&](const QString& text) {
      for (QPushButton* b : panel()->findChildren<QPushButton*>())
        if (b->text().remove('&') == text) b->click();
    };
    press("Restore preset");
    QCOMPARE(d.preset().seed, 4u);
    QVERIFY(!d.preset().camera);
    QCOMPARE(link_->loaded.seed, 4u);
    QCOMPARE(d.undoStack().count(), steps + 1);
    d.undoStack().undo();
    QCOMPARE(d.preset().seed, 5u);
    QVERIFY(d.preset().camera.has_value());

    press("Delete");
    QCOMPARE(compare().snapshots().all().size(), size_t(0));
    QCOMPARE(compare().choice().b, QString("live"));  // not something that is gone
  }

  /// Light by lobes is offered where the scene has glossy surfaces, and its errors are means over the pixels that see one.
  void specularLightIsComparedWhereThereIsAny() {
    QCOMPARE(parts()->count(), 2);
    glossy_ = true;
    publish({});
    QCOMPARE(parts()->count(), 3);
    QCOMPARE(parts()->itemText(2), QString("Specular light"));
    choose(CompareMode::ErrorMap, "live", "matched");
    parts()->setCurrentIndex(2);
    emit parts()->activated(2);
    QVERIFY(compare().choice().part == PicturePart::Specular);
    QCOMPARE(link_->wanted, (std::vector<std::string>{"reference_matched_specular", "specular"}));
    auto half = std::make_shared<Image>(*plain(vec3(0.5f)));
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth / 2; ++x)
        for (int c = 0; c < 3; ++c) half->pixel(x, y)[c] = 0.75f;
    CompareChoice c = compare().choice();
    c.metric = "bias";
    compare().choose(c);
    publish({{"specular", half}, {"reference_matched_specular", plain(vec3(0.5f))}});
    QTRY_VERIFY2(compare().pictures().value.contains("0.5"), qPrintable(compare().pictures().value + compare().pictures().refused));  // of the glossy half: half as much again

    // A snapshot keeps it, and goes on offering it beside a scene without.
    c.mode = CompareMode::Off;
    compare().choose(c);
    compare().takeSnapshot();
    QVERIFY(std::count(link_->wanted.begin(), link_->wanted.end(), "specular"));
    publish({{"final", plain(vec3(0.25f))}, {"indirect_irradiance", plain(vec3(0.5f))}});
    QCOMPARE(compare().snapshots().all().size(), size_t(0));  // not without it
    publish({{"final", plain(vec3(0.25f))}, {"indirect_irradiance", plain(vec3(0.5f))}, {"specular", plain(vec3(0.125f))}});
    QCOMPARE(compare().snapshots().all().size(), size_t(1));
    const Snapshot& kept = compare().snapshots().all()[0];
    QVERIFY(kept.specular && kept.specular->pixel(0, 0)[0] == 0.125f);
    QCOMPARE(kept.bytes() - static_cast<size_t>(kept.thumbnail.sizeInBytes()), 3 * static_cast<size_t>(kWidth) * kHeight * 3 * sizeof(float));
    const QString snapshot = "snapshot " + QString::number(kept.id);
    choose(CompareMode::WipeAcross, snapshot, "live");
    c = compare().choice();
    c.part = PicturePart::Specular;
    compare().choose(c);
    publish({{"specular", plain(vec3(0.75f))}});
    QTRY_COMPARE(seen(0.75, 0.5), toneMapped(vec3(0.75f)));
    QCOMPARE(seen(0.25, 0.5), toneMapped(vec3(0.125f)));
    glossy_ = false;
    publish({});
    QCOMPARE(parts()->count(), 3);
    QTRY_VERIFY(compare().pictures().refused.contains("no glossy surfaces"));
    compare().snapshots().remove(kept.id);
    QCOMPARE(parts()->count(), 2);
    QVERIFY(compare().choice().part == PicturePart::Final);
  }

  void theirMemoryIsBounded() {
    const size_t one = static_cast<size_t>(kWidth) * kHeight * 3 * sizeof(float) * 2;
    Snapshots few(nullptr, one * 5 / 2);
    QSignalSpy refused(&few, &Snapshots::refused);
    FrameResult f;
    f.images = {{"final", plain(vec3(1))}, {"indirect_irradiance", plain(vec3(1))}};
    const int first = few.add(f, "first");
    QVERIFY(first && few.add(f, {}));
    QCOMPARE(few.add(f, "third"), 0);
    QCOMPARE(refused.size(), 1);
    QCOMPARE(few.all().size(), size_t(2));
    QCOMPARE(few.bytes(), 2 * one);
    few.remove(first);
    QVERIFY(few.add(f, "third") > 2);
  }

  void zoomAndPanStayOnThePicture() {
    PictureView view;
    const QSizeF size(200, 100);
    const QRectF pane(0, 0, 400, 400);
    QCOMPARE(view.place(size, pane), QRectF(0, 100, 400, 200));
    view.zoomAt({100, 150}, 4, size, pane);
    const QRectF large = view.place(size, pane);
    QCOMPARE(large.width(), 1600.0);
    QCOMPARE((100 - large.x()) / large.width(), 0.25);
    QCOMPARE((150 - large.y()) / large.height(), 0.25);
    view.panBy({1e6, 1e6}, size, pane);
    QVERIFY(view.place(size, pane).contains(pane.center() + QPointF(1, 1)));
    view.zoomAt({0, 0}, 1e9, size, pane);
    QCOMPARE(view.zoom(), PictureView::kLargest);
    view.zoomAt({0, 0}, 1e-9, size, pane);
    QCOMPARE(view.place(size, pane), QRectF(0, 100, 400, 200));
  }

  void theLineAndTheModesAreReachedByKeys() {
    show(CompareMode::Flicker, vec3(0.1f), vec3(0.2f));
    QTest::keyClick(window_.get(), Qt::Key_F4);
    QCOMPARE(compare().choice().mode, CompareMode::WipeDown);
    QTest::keyClick(window_.get(), Qt::Key_X);
    QCOMPARE(compare().choice().a, QString("full"));
    QTest::keyClick(window_.get(), Qt::Key_F2);
    QCOMPARE(compare().choice().mode, CompareMode::Off);
    for (const QWidget* w : panel()->findChildren<QWidget*>())
      if (w->focusPolicy() & Qt::TabFocus && (qobject_cast<const QComboBox*>(w) || qobject_cast<const QSlider*>(w) || qobject_cast<const QListWidget*>(w)))
        QVERIFY2(!w->accessibleName().isEmpty(), w->metaObject()->className());
  }
};

}  // namespace

QTEST_MAIN(CompareTest)
#include "compare_test.moc"
