// Pixel inspector and regions of interest: from the mouse, and by number. Without an engine behind it.
#include <QApplication>
#include <QClipboard>
#include <QDockWidget>
#include <QLabel>
#include <QPushButton>
#include <QSpinBox>
#include <QTableWidget>
#include <QTest>
#include <cmath>

#include "fake_window.h"
#include "ui/error_dock.h"
#include "ui/inspector.h"
#include "ui/regions_editor.h"
#include "ui/viewport.h"

namespace {

using namespace hl;
using namespace hl::ui;

constexpr int kWidth = 64, kHeight = 36;

/// Each pixel's own values: x / 10, y / 10 and `blue`.
std::shared_ptr<const Image> places(float blue) {
  auto image = std::make_shared<Image>(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) image->pixel(x, y)[0] = static_cast<float>(x) / 10, image->pixel(x, y)[1] = static_cast<float>(y) / 10, image->pixel(x, y)[2] = blue;
  return image;
}

class InspectorTest : public FakeWindowTest {
  Q_OBJECT

  std::shared_ptr<Scene> scene_;
  uint64_t number_ = 0;

  Viewport& viewport() { return window_->viewport(); }
  Document& document() { return window_->document(); }
  InspectorPanel* inspector() { return window_->findChild<InspectorPanel*>(); }
  QString cell(int row, int column) { return inspector()->findChild<QTableWidget*>()->item(row, column)->text(); }

  bool glossy_ = false;

  void publish(const std::set<std::string>& missing = {}) {
    auto f = std::make_shared<FrameResult>();
    f->features.glossySurfaces = glossy_;
    f->number = ++number_, f->width = kWidth, f->height = kHeight;
    f->display.resize(static_cast<size_t>(kWidth) * kHeight * 4, 0);
    const std::map<std::string, float> blue = {{"final", 0.5f}, {"indirect_irradiance", 2}, {"reference", 0.25f}, {"reference_indirect", 1.5f}, {"reference_matched", 0.75f}, {"reference_matched_indirect", 2.5f}, {"specular", 3}, {"reference_specular", 2.75f}, {"reference_matched_specular", 4}};
    for (const std::string& name : link_->wanted)
      if (!missing.count(name)) f->images[name] = places(blue.at(name));
    f->scene = scene_;
    f->preset = document().preset();
    const QStringList words = link_->calls.filter("pick").isEmpty() ? QStringList() : link_->calls.filter("pick").last().split(' ');
    if (words.size() == 3) {
      f->picked.x = words[1].toInt(), f->picked.y = words[2].toInt(), f->picked.triangle = 17;
      f->pick.facts = {{"texel", "(3, 4)"}};
    }
    link_->publish(f);
    QTest::qWait(150);  // panels are refreshed ten times a second
  }
  QPoint inWidget(double x, double y) {
    const QRectF r = viewport().pictureRect();
    return (r.topLeft() + QPointF(r.width() * x / kWidth, r.height() * y / kHeight)).toPoint();
  }
  void drag(QPoint from, QPoint to, Qt::KeyboardModifiers modifiers) {
    QTest::mousePress(&viewport(), Qt::LeftButton, modifiers, from);
    QTest::mouseMove(&viewport(), (from + to) / 2);
    QTest::mouseMove(&viewport(), to);
    QTest::mouseRelease(&viewport(), Qt::LeftButton, modifiers, to);
  }

 private slots:
  void init() {
    glossy_ = false;
    scene_ = std::make_shared<Scene>();
    scene_->name = "box", scene_->hash = "1";
    scene_->cameras.resize(1);
    scene_->regions = {{"ceiling", 0, 0, 1, 0.25f}};
    scene_->bounds.extend(vec3(-1)), scene_->bounds.extend(vec3(1));
    openWindow();
    Preset p;
    p.technique = "none";
    p.width = kWidth, p.height = kHeight;
    emit link_->opened(p, {});
    publish();
  }
  void cleanup() { closeWindow(); }

  void aRightClickShowsAllThreePicturesValues() {
    QVERIFY(link_->wanted.empty());  // nothing is copied before someone asks
    QTest::mouseClick(&viewport(), Qt::RightButton, {}, inWidget(20.5, 10.5));
    QVERIFY(window_->findChild<QDockWidget*>("inspectorDock")->isVisible() && inspector()->isVisible());
    QCOMPARE(inspector()->pixel(), std::optional(QPoint(20, 10)));
    QVERIFY(link_->calls.contains("pick 20 10"));
    QCOMPARE(link_->wanted.size(), size_t(6));
    publish();
    QCOMPARE(cell(0, 0), QString("2"));
    QCOMPARE(cell(0, 1), QString("1"));
    QCOMPARE(cell(0, 2), QString("2"));       // indirect of the technique
    QCOMPARE(cell(1, 2), QString("2.5"));     // matched
    QCOMPARE(cell(2, 2), QString("1.5"));     // full
    QCOMPARE(cell(3, 2), QString("-0.5"));
    QCOMPARE(cell(4, 2), QString("0.5"));
    QCOMPARE(cell(0, 5), QString("0.5"));     // final
    QCOMPARE(cell(4, 5), QString("0.25"));
    // Its neighbourhood, with the pixel itself in the middle.
    const auto patches = inspector()->findChildren<Neighbourhood*>();
    QCOMPARE(patches.size(), 3);
    const QImage shot = patches[0]->grab().toImage();
    const auto bytes = toneMapOnHost(*places(0.5f), document().preset().display);
    const auto at = [&](int x, int y) { return QColor(bytes[static_cast<size_t>(y * kWidth + x) * 4], bytes[static_cast<size_t>(y * kWidth + x) * 4 + 1], bytes[static_cast<size_t>(y * kWidth + x) * 4 + 2]); };
    const auto seen = [&](int dx, int dy) { return shot.pixelColor(static_cast<int>((5.5 + dx) * 9 * shot.devicePixelRatio()), static_cast<int>((5.5 + dy) * 9 * shot.devicePixelRatio())); };
    QCOMPARE(seen(0, 0), at(20, 10));
    QCOMPARE(seen(-4, 3), at(16, 13));
    // Copied as text, facts and all.
    for (QPushButton* b : inspector()->findChildren<QPushButton*>())
      if (b->text().contains("text")) b->click();
    const QString text = QApplication::clipboard()->text();
    for (const char* part : {"Pixel 20, 10", "Matched reference", "-0.5", "triangle 17", "texel: (3, 4)"}) QVERIFY2(text.contains(part), qPrintable(text));
  }

  /// Light by lobes has columns of its own where the scene has glossy surfaces, and is not asked for where it has none.
  void specularLightIsShownWhereThereIsAny() {
    QTest::mouseClick(&viewport(), Qt::RightButton, {}, inWidget(20.5, 10.5));
    publish();
    auto* table = inspector()->findChild<QTableWidget*>();
    QVERIFY(table->isColumnHidden(6));
    QVERIFY(!inspector()->text().contains("specular"));
    glossy_ = true;
    publish();
    QCOMPARE(link_->wanted.size(), size_t(9));
    publish();
    QVERIFY(!table->isColumnHidden(6));
    QCOMPARE(cell(0, 8), QString("3"));       // the technique's
    QCOMPARE(cell(1, 8), QString("4"));       // matched
    QCOMPARE(cell(2, 8), QString("2.75"));    // full
    QCOMPARE(cell(3, 8), QString("-1"));
    QCOMPARE(cell(4, 8), QString("0.25"));
    QCOMPARE(cell(0, 5), QString("0.5"));     // final, where it was
    const QString text = inspector()->text();
    QVERIFY2(text.contains("specular B") && text.contains("2.75"), qPrintable(text));
    glossy_ = false;
    publish();
    QVERIFY(table->isColumnHidden(6));
    QCOMPARE(link_->wanted.size(), size_t(6));
  }

  void byNumberAndWithoutAReference() {
    auto* dock = window_->findChild<QDockWidget*>("inspectorDock");
    dock->raise();
    QTRY_VERIFY(inspector()->isVisible());
    auto boxes = inspector()->findChildren<QSpinBox*>();
    boxes[0]->setValue(63);
    boxes[1]->setValue(99);
    QCOMPARE(inspector()->pixel(), std::optional(QPoint(63, 35)));  // brought into the picture
    QCOMPARE(boxes[1]->value(), 35);
    publish({"reference", "reference_indirect", "reference_matched", "reference_matched_indirect"});
    QCOMPARE(cell(0, 0), QString("6.3"));
    QCOMPARE(cell(1, 0), QString("-"));
    QCOMPARE(cell(3, 0), QString("-"));
    for (QPushButton* b : inspector()->findChildren<QPushButton*>())
      if (b->text().contains("reference")) {
        QVERIFY(b->isVisible());
        b->click();
      }
    QVERIFY(link_->calls.contains("reference on"));
    dock->close();
    QTRY_VERIFY(!inspector()->isVisible());
    QVERIFY(link_->wanted.empty());  // unseen, it costs nothing
  }

  void aRegionIsDraggedOnWholePixels() {
    QTest::keyClick(window_.get(), Qt::Key_R);
    drag(inWidget(8.2, 4.3), inWidget(24.1, 19.8), {});
    QVERIFY(!document().preset().camera);  // the camera stays
    QVERIFY(document().preset().regions.has_value());
    const std::vector<Region> regions = document().regions();
    QCOMPARE(regions.size(), size_t(2));  // the scene's stays
    QCOMPARE(regions[0].name, std::string("ceiling"));
    QCOMPARE(regions[1].x * kWidth, 8.0f);
    QCOMPARE(regions[1].y * kHeight, 4.0f);
    QCOMPARE(std::round(regions[1].width * kWidth * 1000) / 1000, 16.0f);
    QCOMPARE(std::round(regions[1].height * kHeight * 1000) / 1000, 16.0f);
    QVERIFY(link_->regions && *link_->regions == regions);
    // Seen in the picture.
    const QImage shot = viewport().grab().toImage();
    const QPoint edge = inWidget(16, 4);
    bool line = false;
    for (int dy = -3; dy <= 3; ++dy) line |= shot.pixelColor((edge + QPoint(0, dy)) * shot.devicePixelRatio()).red() > 200;
    QVERIFY(line);
    QTest::keyClick(&viewport(), Qt::Key_Escape);
    QVERIFY(!viewport().regionTool());
    // With the modifiers, at any time; too small a one is none.
    drag(inWidget(30, 20), inWidget(40, 30), Qt::ControlModifier | Qt::ShiftModifier);
    QCOMPARE(document().regions().size(), size_t(3));
    QCOMPARE(document().regions()[2].name, std::string("region 2"));
    drag(inWidget(30, 20), inWidget(30, 20), Qt::ControlModifier | Qt::ShiftModifier);
    QCOMPARE(document().regions().size(), size_t(3));
    document().undoStack().undo();
    document().undoStack().undo();
    QVERIFY(!document().preset().regions);
    QVERIFY(!link_->regions);  // the scene's own again
    QCOMPARE(document().regions().size(), size_t(1));
  }

  void regionsByNumber() {
    auto* editor = window_->findChild<RegionsEditor*>();
    auto* table = editor->findChild<QTableWidget*>();
    QCOMPARE(table->rowCount(), 1);
    const auto press = [&](const QString& text) {
      for (QPushButton* b : editor->findChildren<QPushButton*>())
        if (b->text().remove('&') == text) b->click();
    };
    press("Add");
    QCOMPARE(table->rowCount(), 2);
    table->item(1, 0)->setText("shadow");
    table->item(1, 3)->setText("10");
    QCOMPARE(document().regions()[1].name, std::string("shadow"));
    QCOMPARE(document().regions()[1].width, 10.0f / kWidth);
    for (const auto& [column, text] : {std::pair{3, "0"}, {3, "600"}, {1, "x"}, {0, "ceiling"}, {0, ""}}) {
      const auto before = document().regions();
      table->item(1, column)->setText(text);
      QVERIFY2(document().regions() == before, text);
      QVERIFY(table->item(1, column)->text() != text);  // put back
    }
    table->setCurrentCell(1, 0);
    press("Remove");
    QCOMPARE(document().regions().size(), size_t(1));
    // Their errors are in the table of errors.
    auto f = std::make_shared<FrameResult>(*link_->frame);
    ErrorValue e;
    e.reference = "matched", e.target = "image", e.component = "indirect", e.metric = "relmse", e.value = 0.5, e.roi = "ceiling";
    f->errors = {e};
    window_->findChild<QDockWidget*>("errorDock")->raise();
    link_->publish(f);
    bool found = false;
    QVERIFY(QTest::qWaitFor([&] {
      for (const QTableWidget* t : window_->findChild<ErrorPanel*>()->findChildren<QTableWidget*>())
        for (int r = 0; r < t->rowCount(); ++r)
          for (int c = 0; c < t->columnCount(); ++c) found |= t->item(r, c) && t->item(r, c)->text().contains("ceiling") && t->columnCount() == 6;
      return found;
    }));
  }

  void regionsAreKeptInThePreset() {
    Preset p = document().preset();
    p.regions = std::vector<Region>{{"left", 0, 0, 0.5f, 1}, {"a \u00e9", 0.1f, 0.2f, 0.3f, 0.4f}};
    const Preset back = presetFromJson(presetJson(p), "text");
    QVERIFY(back.regions == p.regions);
    QCOMPARE(presetHash(back), presetHash(document().preset()));  // no picture depends on them
    for (const char* bad : {"[{\"name\": \"a\", \"width\": 2}]", "[{\"x\": 0}]", "[{\"name\": \"a\"}, {\"name\": \"a\"}]", "{}", "[{\"name\": \"a\", \"x\": 0.6, \"width\": 0.6}]"})
      QVERIFY_EXCEPTION_THROWN(presetFromJson(std::string("{\"version\": 1, \"scene\": \"cornell_box\", \"regions\": ") + bad + "}", "text"), Error);
  }
};

}  // namespace

QTEST_MAIN(InspectorTest)
#include "inspector_test.moc"
