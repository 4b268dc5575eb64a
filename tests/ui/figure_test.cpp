// Figures: where things lie, what they show, and the files that come of it.
#include <QImage>
#include <QListWidget>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <limits>

#include "engine/core/image_io.h"
#include "engine/experiment/open_target.h"
#include "fake_link.h"
#include "ui/comparison.h"
#include "ui/figure.h"
#include "ui/figure_dialog.h"

namespace {

using namespace hl;
using namespace hl::ui;

/// `left` with its right half in `right`.
std::shared_ptr<const Image> halves(vec3 left, vec3 right, int width = 64, int height = 36) {
  auto image = std::make_shared<Image>(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) image->pixel(x, y)[c] = (x < width / 2 ? left : right)[c];
  return image;
}

class FigureTest : public QObject {
  Q_OBJECT

  QTemporaryDir folder_;

  static FigureSheet sheet() {
    auto frame = std::make_shared<FrameResult>();
    frame->preset.seed = 42;
    frame->provenance.device = "a device";
    FigureSheet f;
    f.images = {{"Radiosity", halves(vec3(0.1f), vec3(0.5f)), frame, {}}, {"Reference", halves(vec3(0.2f), vec3(0.5f)), nullptr, {}}};
    f.metrics = {"mse", "flip"};
    f.truth = f.images[1].image, f.truthName = "Reference";
    f.insets = {{"left", 0, 0.25f, 0.25f, 0.5f}, {"right", 0.75f, 0.25f, 0.25f, 0.5f}};
    return f;
  }
  static QColor toneMapped(float v) {
    const auto bytes = toneMapOnHost(*halves(vec3(v), vec3(v), 2, 1), hl::Display());
    return QColor(bytes[0], bytes[1], bytes[2]);
  }

 private slots:
  void everythingHasAPlaceOfItsOwn() {
    for (size_t count = 1; count <= 9; ++count) {
      FigureSheet f = sheet();
      f.images.resize(1);
      while (f.images.size() < count) f.images.push_back({"more", halves(vec3(1), vec3(1), 30, 40), nullptr, {}});
      const FigureLayout layout = layOut(f);
      QCOMPARE(layout.cells.size(), count);
      std::vector<QRectF> all;
      for (const FigureCell& c : layout.cells) {
        all.insert(all.end(), {c.picture, c.caption, c.metrics});
        all.insert(all.end(), c.insets.begin(), c.insets.end());
        QCOMPARE(c.insets.size(), size_t(2));
      }
      for (size_t i = 0; i < all.size(); ++i) {
        QVERIFY(QRectF(QPointF(), layout.page).contains(all[i]));
        for (size_t j = i + 1; j < all.size(); ++j) QVERIFY((all[i] & all[j]).isEmpty());
      }
      QVERIFY(std::abs(layout.cells[0].picture.width() / layout.cells[0].picture.height() - 64.0 / 36) < 1e-9);
    }
  }

  void aPngShowsPicturesInsetsAndCarriesThePreset() {
    const QString path = folder_.filePath("figure.png");
    writeFigure(sheet(), path.toStdString());
    const QImage page(path);
    const FigureLayout layout = layOut(sheet());
    const double scale = page.width() / layout.page.width();
    QCOMPARE(scale, 4.0);
    const auto at = [&](const QRectF& box, double x, double y) { return page.pixelColor(((box.topLeft() + QPointF(box.width() * x, box.height() * y)) * scale).toPoint()); };
    QCOMPARE(at(layout.cells[0].picture, 0.4, 0.1), toneMapped(0.1f));
    QCOMPARE(at(layout.cells[0].picture, 0.6, 0.1), toneMapped(0.5f));
    QCOMPARE(at(layout.cells[1].picture, 0.4, 0.1), toneMapped(0.2f));
    QCOMPARE(at(layout.cells[0].insets[0], 0.5, 0.5), toneMapped(0.1f));
    QCOMPARE(at(layout.cells[0].insets[1], 0.5, 0.5), toneMapped(0.5f));
    const QColor frame = at(layout.cells[0].insets[0], 0, 0.5);
    QVERIFY(frame.blue() > frame.red() + 60);  // its region's colour
    bool caption = false;
    for (double x = 0; x < 1; x += 0.002)
      for (double y = 0.1; y < 0.9; y += 0.1) caption |= at(layout.cells[0].caption, x, y).lightness() < 100;
    QVERIFY(caption);
    const Preset inside = openTarget(path.toStdString());
    QCOMPARE(inside.seed, 42u);
    QVERIFY(readImage(path.toStdString()).metadata.at(kProvenanceAttribute).find("a device") != std::string::npos);
  }

  /// Over the pixels that see a surface, and free of the reference's variance, as the engine's are.
  void metricsAreTheEngines() {
    FigureSheet f = sheet();
    auto truth = std::make_shared<ReferenceImage>(ReferenceImage{*f.truth, *halves(vec3(0.1f), vec3(0.4f)), *halves(vec3(0.3f), vec3(0.6f))});
    auto surfaces = std::make_shared<Mask>(f.truth->pixels(), 0);
    for (size_t i = 0; i < surfaces->size() / 2; ++i) (*surfaces)[i] = 1;
    f.metrics = {"mse"};
    f.images[0].context = {truth, surfaces};
    const double mse = measure("mse", *f.images[0].image, *truth, *surfaces).value;
    QVERIFY(mse != measure("mse", *f.images[0].image, ReferenceImage{*f.truth, {}, {}}).value);
    QVERIFY2(figureMetrics(f)[0][0].contains(QString::number(mse, 'g', 3)), qPrintable(figureMetrics(f)[0][0]));
    auto broken = std::make_shared<Image>(*f.images[0].image);
    broken->data[0] = std::numeric_limits<float>::quiet_NaN();
    f.images[0].image = broken;
    QVERIFY2(figureMetrics(f)[0][0].contains("1 pixels are NaN or Inf"), qPrintable(figureMetrics(f)[0][0]));
  }

  void metricsAreThoseOfThePictures() {
    const auto lines = figureMetrics(sheet());
    QCOMPARE(lines[0].size(), 2);
    const double mse = measure("mse", *sheet().images[0].image, ReferenceImage{*sheet().images[1].image, {}, {}}).value;
    QVERIFY2(lines[0][0].contains(QString::number(mse, 'g', 3)) && lines[0][0].contains("Reference"), qPrintable(lines[0][0]));
    FigureSheet same = sheet();
    same.truth = same.images[1].image;
    QVERIFY(figureMetrics(same)[1].isEmpty());  // a picture against itself says nothing
  }

  void aPdfIsOnePage() {
    const QString path = folder_.filePath("figure.pdf");
    writeFigure(sheet(), path.toStdString());
    QFile file(path);
    QVERIFY(file.open(QIODevice::ReadOnly));
    const QByteArray bytes = file.readAll();
    QVERIFY(bytes.startsWith("%PDF-"));
    QVERIFY(bytes.trimmed().endsWith("%%EOF"));
    QCOMPARE(bytes.count("/Type /Page\n"), 1);
    QVERIFY(bytes.contains("1-preset.json"));
    QVERIFY(bytes.count("/Subtype /Image") >= 2);
  }

  void whatMakesNoFigureIsRefusedAndNoFileIsLeft() {
    FigureSheet f = sheet();
    f.images[1].image.reset();
    QVERIFY_EXCEPTION_THROWN(writeFigure(f, folder_.filePath("a.png").toStdString()), Error);
    f.images.clear();
    QVERIFY_EXCEPTION_THROWN(writeFigure(f, folder_.filePath("a.png").toStdString()), Error);
    QVERIFY_EXCEPTION_THROWN(writeFigure(sheet(), folder_.filePath("a.jpg").toStdString()), Error);
    f = sheet();
    f.truth = halves(vec3(1), vec3(1), 10, 10);
    QVERIFY_EXCEPTION_THROWN(writeFigure(f, folder_.filePath("a.png").toStdString()), Error);
    QVERIFY_EXCEPTION_THROWN(writeFigure(sheet(), folder_.filePath("no/such/folder/a.pdf").toStdString()), Error);
    QVERIFY(!QFile::exists(folder_.filePath("a.png")));
  }

  /// As a person makes one: what is chosen is asked of the engine, and written off the window's thread.
  void theDialogWritesWhatIsChosen() {
    FakeLink link;
    Catalog catalog;
    Document document(link, catalog);
    ImageFeed feed(link);
    Compare compare(link, document, feed);
    {
      FigureDialog dialog(compare, document, feed);
      QCOMPARE(link.wanted, (std::vector<std::string>{"final", "reference"}));
      QSignalSpy refused(&dialog, &FigureDialog::refused), written(&dialog, &FigureDialog::written);
      dialog.write(folder_.filePath("dialog.png"));
      QTRY_COMPARE(refused.size(), 1);  // no picture yet
      auto frame = std::make_shared<FrameResult>();
      frame->images = {{"final", halves(vec3(0.1f), vec3(0.5f))}, {"reference", halves(vec3(0.2f), vec3(0.5f))}};
      link.publish(frame);
      dialog.findChildren<QListWidget*>().front()->item(0)->setText("mine");
      QCOMPARE(dialog.figure().images.front().caption, QString("mine"));
      dialog.write(folder_.filePath("dialog.png"));
      QTRY_COMPARE(written.size(), 1);
      QVERIFY(!QImage(folder_.filePath("dialog.png")).isNull());
      QCOMPARE(refused.size(), 1);
    }
    QVERIFY(link.wanted.empty());
  }
};

}  // namespace

QTEST_MAIN(FigureTest)
#include "figure_test.moc"
