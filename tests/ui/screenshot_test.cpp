// Screenshots dropped on the window bring the experiment back; whatever else is dropped is refused or warned of in one line, and nothing is lost.
#include <QAction>
#include <QDragEnterEvent>
#include <QFile>
#include <QFileDialog>
#include <QImage>
#include <QJsonDocument>
#include <QJsonObject>
#include <QMimeData>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <QUrl>

#include "engine/core/image_io.h"
#include "engine/experiment/open_target.h"
#include "ui/main_window.h"
#include "ui/preset_actions.h"
#include "ui/session_link.h"
#include "ui/settings.h"
#include "ui/viewport.h"

namespace {

using namespace hl;
using namespace hl::ui;

constexpr int kLongest = 240000;  // ms, on a busy machine

/// Not the default: the cheapest end of its range, as a rule.
std::string anotherText(const ParamInfo& p) {
  if (p.type == ParamType::Bool) return p.def != 0 ? "false" : "true";
  if (p.type == ParamType::Enum) return std::string(p.values[p.def != 0 || p.values.size() < 2 ? 0 : 1].name);
  const double v = p.softMin != p.def ? p.softMin : p.type == ParamType::Int ? p.def + 1 : (p.def + p.softMax) / 2;
  return formatParam(p, p.type == ParamType::Int ? ParamValue(static_cast<int32_t>(v)) : ParamValue(static_cast<float>(v)));
}

class ScreenshotTest : public QObject {
  Q_OBJECT

  QTemporaryDir folder_;
  std::unique_ptr<Settings> settings_;
  std::unique_ptr<SessionLink> link_;
  std::unique_ptr<MainWindow> window_;
  Preset made_;  ///< of the screenshots

  Document& document() { return window_->document(); }
  void drop(const QString& path) {
    QMimeData file;
    file.setUrls({QUrl::fromLocalFile(path)});
    QDragEnterEvent enter(QPoint(10, 10), Qt::CopyAction, &file, Qt::LeftButton, Qt::NoModifier);
    QCoreApplication::sendEvent(window_.get(), &enter);
    QVERIFY(enter.isAccepted());
    QDropEvent event(QPointF(10, 10), Qt::CopyAction, &file, Qt::LeftButton, Qt::NoModifier);
    QCoreApplication::sendEvent(window_.get(), &event);
  }
  /// The experiment that runs and the one that the panels show.
  bool comesBack(const Preset& wanted) {
    const std::string json = presetJson(wanted);
    return QTest::qWaitFor(
        [&] { return link_->latest() && presetJson(link_->latest()->preset) == json && presetJson(document().preset()) == json; }, kLongest);
  }
  bool settles() {
    return QTest::qWaitFor([&] { return link_->latest() && link_->latest()->settled; }, kLongest);
  }
  QString file(const QString& name, const QByteArray& bytes) {
    QFile f(folder_.filePath(name));
    if (!f.open(QIODevice::WriteOnly)) qFatal("cannot write %s", qPrintable(f.fileName()));
    f.write(bytes);
    return f.fileName();
  }
  static QByteArray bytesOf(const QString& path) {
    QFile f(path);
    return f.open(QIODevice::ReadOnly) ? f.readAll() : QByteArray();
  }
  /// Through the menu and its dialog, as a person saves one.
  void save(const QString& path) {
    QSignalSpy saved(link_.get(), &EngineLink::saved);
    for (QAction* action : window_->findChildren<QAction*>())
      if (action->shortcut() == QKeySequence(Qt::Key_F12)) action->trigger();
    auto* dialog = window_->findChild<QFileDialog*>();
    QVERIFY(dialog);
    emit dialog->fileSelected(path);
    dialog->close();
    QTRY_COMPARE_WITH_TIMEOUT(saved.size(), 1, kLongest);
    QCOMPARE(saved[0][1].toString(), QString("screenshot"));
    QTRY_VERIFY(!window_->findChild<QFileDialog*>());
  }

 private slots:
  void initTestCase() {
    settings_ = std::make_unique<Settings>(folder_.filePath("settings.ini"));
    SessionOptions options;
    options.device.validation = true;
    link_ = std::make_unique<SessionLink>(options);
    Preset p;
    p.width = 64, p.height = 36;
    p.parameters = {{"lightmap.resolution", "32"}, {"radiosity.samples", "16"}, {"radiosity.bounces", "2"}};
    savePreset(p, folder_.filePath("start.json").toStdString());
    window_ = std::make_unique<MainWindow>(*link_, *settings_, folder_.filePath("start.json"));
    window_->show();
    QVERIFY(comesBack(p));
  }
  void cleanupTestCase() { window_.reset(), link_.reset(), settings_.reset(); }

  void savingCarriesEverything() {
    std::map<std::string, std::string> texts;
    const TechniqueEntry* technique = document().catalog().technique("radiosity");
    for (const ParameterGroup& group : technique->groups)
      for (const ParamInfo& p : group.infos)
        if (p.type != ParamType::Enum || p.values.size() > 1) texts[p.key()] = anotherText(p);
    texts["lightmap.resolution"] = "40";
    document().editParameters(texts, "all");
    for (const auto& [key, text] : texts) QVERIFY2(document().preset().parameters.count(key), (key + " is at its default").c_str());
    hl::Display display = document().preset().display;
    display.exposure = 1.25f, display.toneMap = ToneMap::Aces, display.view = "indirect", display.showInvalid = true;
    document().editDisplay(display, "display");
    document().editResolution(80, 40);
    document().editSeed(77);
    Camera camera = *document().camera();
    camera.position += vec3(0.0123f, 0.1f, -0.05f), camera.verticalFov = 0.7f;
    document().moveCamera(camera);
    made_ = document().preset();
    QVERIFY(comesBack(made_));
    QVERIFY(settles());
    save(folder_.filePath("shot.png"));
    save(folder_.filePath("shot.exr"));

    const auto frame = link_->latest();
    const QImage png(folder_.filePath("shot.png"));
    QCOMPARE(png.size(), QSize(80, 40));
    for (const char* name : {"shot.png", "shot.exr"}) {
      const Image image = readImage(folder_.filePath(name).toStdString());
      QCOMPARE(presetJson(presetFromJson(image.metadata.at(kPresetAttribute), name)), presetJson(made_));
      const QJsonObject from = QJsonDocument::fromJson(QByteArray::fromStdString(image.metadata.at(kProvenanceAttribute))).object();
      QCOMPARE(from["preset_hash"].toString().toStdString(), presetHash(made_));
      QCOMPARE(from["seed"].toInt(), 77);
      QCOMPARE(from["device"].toString().toStdString(), frame->provenance.device);
    }
    // The EXR is the linear final picture, whatever view the window shows.
    link_->setImagesWanted({"final"});
    QVERIFY(QTest::qWaitFor([&] { return link_->latest()->images.count("final") > 0; }, kLongest));
    const Image exr = readImage(folder_.filePath("shot.exr").toStdString());
    QVERIFY(exr.data == link_->latest()->images.at("final")->data);
    link_->setImagesWanted({});
  }

  void aPausedWindowSavesToo() {
    link_->setPaused(true);
    save(folder_.filePath("paused.exr"));
    link_->setPaused(false);
    QCOMPARE(presetJson(openTarget(folder_.filePath("paused.exr").toStdString())), presetJson(made_));
  }

  void droppingBringsItBack_data() {
    QTest::addColumn<QString>("name");
    for (const char* n : {"shot.png", "shot.exr"}) QTest::newRow(n) << n;
  }
  void droppingBringsItBack() {
    QFETCH(QString, name);
    drop(folder_.filePath("start.json"));
    QTRY_COMPARE_WITH_TIMEOUT(document().preset().seed, 1u, kLongest);
    QTRY_COMPARE_WITH_TIMEOUT(link_->latest()->preset.seed, 1u, kLongest);
    document().editTechnique("none");
    document().useCamera("");
    const int steps = document().undoStack().count();
    drop(folder_.filePath(name));
    QVERIFY(comesBack(made_));
    QCOMPARE(document().camera()->verticalFov, 0.7f);
    QCOMPARE(window_->noticeText(), QString());
    // One step, which undo takes back.
    QCOMPARE(document().undoStack().count(), steps + 1);
    document().undoStack().undo();
    QCOMPARE(document().preset().technique, std::string("none"));
    document().undoStack().redo();
    QVERIFY(comesBack(made_));
  }

  void aSceneKeepsTechniqueAndParameters() {
    const QString scene = QStringLiteral(HALFLIGHT_SOURCE "/scenes/cornell_sphere.json");
    drop(scene);
    QTRY_COMPARE_WITH_TIMEOUT(document().preset().scene, scene.toStdString(), kLongest);
    QCOMPARE(document().preset().parameters, made_.parameters);
    QCOMPARE(document().preset().seed, 77u);
    document().undoStack().undo();
    QVERIFY(comesBack(made_));
  }

  void aNewerPresetWarnsAndLoadsWhatIsKnown() {
    Image image = readImage(folder_.filePath("shot.png").toStdString());
    QJsonObject preset = QJsonDocument::fromJson(QByteArray::fromStdString(image.metadata.at(kPresetAttribute))).object();
    preset["version"] = kPresetVersion + 1;
    preset["hologram"] = true;
    image.metadata[kPresetAttribute] = QJsonDocument(preset).toJson(QJsonDocument::Compact).toStdString();
    writeImage(folder_.filePath("newer.png").toStdString(), image);
    document().editSeed(5);
    QSignalSpy opened(&document(), &Document::openedFile);
    drop(folder_.filePath("newer.png"));
    QTRY_COMPARE_WITH_TIMEOUT(opened.size(), 1, kLongest);
    QVERIFY(comesBack(made_));
    QVERIFY2(window_->noticeText().contains("hologram"), qPrintable(window_->noticeText()));
    QVERIFY(!window_->noticeText().contains('\n'));
    QVERIFY(link_->latest()->message.empty());  // it would be told twice
  }

  /// Ctrl+S would drop what this version does not know of the file: it asks where to save instead.
  void aNewerPresetIsNotSavedOver() {
    QJsonObject preset = QJsonDocument::fromJson(QByteArray::fromStdString(presetJson(made_))).object();
    preset["version"] = kPresetVersion + 1;
    preset["hologram"] = true;
    const QByteArray text = QJsonDocument(preset).toJson();
    const QString path = file("newer.json", text);
    QSignalSpy opened(&document(), &Document::openedFile);
    drop(path);
    QTRY_COMPARE_WITH_TIMEOUT(opened.size(), 1, kLongest);
    QCOMPARE(document().path(), path);
    QSignalSpy saved(link_.get(), &EngineLink::saved);
    const auto triggerSave = [&] {
      for (QAction* action : window_->findChildren<QAction*>())
        if (action->shortcut() == QKeySequence(QKeySequence::Save)) action->trigger();
    };
    triggerSave();
    auto* dialog = window_->findChild<QFileDialog*>();
    QVERIFY(dialog);
    const QString copy = folder_.filePath("known.json");
    emit dialog->fileSelected(copy);
    dialog->close();
    QTRY_COMPARE_WITH_TIMEOUT(saved.size(), 1, kLongest);
    QTRY_VERIFY(!window_->findChild<QFileDialog*>());
    QCOMPARE(bytesOf(path), text);
    QCOMPARE(document().path(), copy);
    triggerSave();  // that one is this version's own
    QVERIFY(!window_->findChild<QFileDialog*>());
    QTRY_COMPARE_WITH_TIMEOUT(saved.size(), 2, kLongest);
  }

  void badOnesAreRefusedInOneLine_data() {
    QTest::addColumn<QString>("path");
    const QByteArray png = bytesOf(folder_.filePath("shot.png"));
    QVERIFY(png.size() > 500);
    QTest::newRow("cut-off PNG") << file("cut.png", png.left(png.size() * 2 / 3));
    QTest::newRow("PNG cut to its header") << file("header.png", png.left(20));
    QByteArray damaged = png;
    for (qsizetype i = damaged.size() / 2; i < damaged.size() / 2 + 40; ++i) damaged[i] = static_cast<char>(i);
    QTest::newRow("damaged PNG") << file("damaged.png", damaged);
    QTest::newRow("cut-off EXR") << file("cut.exr", bytesOf(folder_.filePath("shot.exr")).left(9000));
    QImage plain(8, 8, QImage::Format_RGB32);
    plain.fill(Qt::blue);
    plain.save(folder_.filePath("foreign.png"));
    QTest::newRow("foreign PNG") << folder_.filePath("foreign.png");
    QDir(folder_.path()).mkdir("a folder.png");
    QDir(folder_.path()).mkdir("a folder");
    QTest::newRow("directory") << folder_.filePath("a folder");
    QTest::newRow("directory named like a picture") << folder_.filePath("a folder.png");
    QByteArray noise;
    for (int i = 0; i < 4096; ++i) noise.append(static_cast<char>((i * 2654435761u) >> 11));
    QTest::newRow("binary JSON") << file("binary.json", noise);
    QTest::newRow("a PNG named JSON") << file("picture.json", png);
    QTest::newRow("empty JSON") << file("empty.json", {});
    Image image = readImage(folder_.filePath("shot.png").toStdString());
    image.metadata[kPresetAttribute] = "{\"version\": 1, \"scene\": ";
    writeImage(folder_.filePath("broken.png").toStdString(), image);
    QTest::newRow("a PNG with half a preset") << folder_.filePath("broken.png");
    image.metadata[kPresetAttribute] = "{\"version\": 1, \"scene\": \"no_such_scene\"}";
    writeImage(folder_.filePath("lost.png").toStdString(), image);
    QTest::newRow("a PNG whose scene is not here") << folder_.filePath("lost.png");
  }
  void badOnesAreRefusedInOneLine() {
    QFETCH(QString, path);
    if (document().preset().seed != 78u) document().editSeed(78);
    const Preset before = document().preset();
    QVERIFY(comesBack(before));
    QVERIFY(settles());
    const int steps = document().undoStack().count();
    const std::string picture = link_->latest()->displayHash;
    QSignalSpy failed(link_.get(), &EngineLink::failed), opened(link_.get(), &EngineLink::opened);
    drop(path);
    QTRY_COMPARE_WITH_TIMEOUT(failed.size(), 1, kLongest);
    const QString message = failed[0][0].toString();
    QVERIFY2(!message.contains('\n') && message.size() < 500 && message.size() > 10, qPrintable(message));
    QVERIFY2(message.contains(path.section('/', -1)), qPrintable(message));
    for (const QChar c : message) QVERIFY2(c.isPrint(), qPrintable(message));
    QCOMPARE(window_->noticeText(), message);
    const uint64_t number = link_->latest()->number;
    // Asked for: a session that has nothing more to do sleeps, perhaps before this looks.
    const auto later = [&] {
      if (link_->latest()->number > number + 1 && link_->latest()->settled) return true;
      link_->renderOnce();
      return false;
    };
    QVERIFY(QTest::qWaitFor(later, kLongest));
    QCOMPARE(opened.size(), 0);
    QCOMPARE(presetJson(document().preset()), presetJson(before));
    QCOMPARE(presetJson(link_->latest()->preset), presetJson(before));
    QCOMPARE(document().undoStack().count(), steps);
    QCOMPARE(link_->latest()->displayHash, picture);
  }

  /// Several files, or none on this machine: not taken, so that the person's pointer says so.
  void whatIsNoSingleFileIsNotTaken() {
    QMimeData two;
    two.setUrls({QUrl::fromLocalFile("/a.png"), QUrl::fromLocalFile("/b.png")});
    QVERIFY(!PresetActions::acceptable(two));
    QMimeData web;
    web.setUrls({QUrl("https://example.org/a.png")});
    QVERIFY(!PresetActions::acceptable(web));
  }
};

}  // namespace

QTEST_MAIN(ScreenshotTest)
#include "screenshot_test.moc"
