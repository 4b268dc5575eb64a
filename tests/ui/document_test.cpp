// Edits, undo and redo, and what of it reaches the session.
#include <QTest>

#include "fake_link.h"
#include "ui/document.h"

namespace {

using namespace hl;
using namespace hl::ui;

class DocumentTest : public QObject {
  Q_OBJECT

  FakeLink link_;
  Catalog catalog_;
  std::unique_ptr<Document> document_;

  /// A parameter of the shared groups, which every technique has.
  static constexpr const char* kKey = "direct.samples";
  QString call(const std::string& text) const { return QString("param %1=%2").arg(kKey, QString::fromStdString(text)); }
  std::string defaultOfKey() const { return defaultText(*catalog_.parameter("none", kKey)); }
  void edit(const std::string& text, quint64 drag = 0) { document_->editParameters({{kKey, text}}, "samples", drag); }

 private slots:
  void init() {
    document_ = std::make_unique<Document>(link_, catalog_);
    Preset p;
    p.technique = "none";
    emit link_.opened(p, {});
    link_.takeCalls();
  }

  void anEditReachesTheSessionAndTurnsBack() {
    edit("128");
    QCOMPARE(link_.takeCalls(), QStringList{call("128")});
    QCOMPARE(document_->parameter(kKey), std::string("128"));
    QVERIFY(document_->modified());
    document_->undoStack().undo();
    QCOMPARE(link_.takeCalls(), QStringList{call(defaultOfKey())});
    QVERIFY(document_->preset().parameters.empty());
    QVERIFY(!document_->modified());
    document_->undoStack().redo();
    QCOMPARE(link_.takeCalls(), QStringList{call("128")});
    QCOMPARE(document_->preset().parameters.at(kKey), std::string("128"));
  }

  void aDragIsOneStep() {
    const quint64 first = document_->newDrag(), second = document_->newDrag();
    for (const char* v : {"70", "80", "90"}) edit(v, first);
    for (const char* v : {"100", "110"}) edit(v, second);
    QCOMPARE(document_->undoStack().count(), 2);
    QCOMPARE(link_.takeCalls().size(), 5);  // the session saw all of them
    document_->undoStack().undo();
    QCOMPARE(document_->parameter(kKey), std::string("90"));
    document_->undoStack().undo();
    QCOMPARE(document_->parameter(kKey), defaultOfKey());
  }

  void aDragBackToItsStartIsNoStep() {
    const quint64 drag = document_->newDrag();
    edit("70", drag);
    edit(defaultOfKey(), drag);
    QCOMPARE(document_->undoStack().count(), 0);
    QVERIFY(!document_->modified());
  }

  void techniqueSwitchTurnsBackWithItsParameters() {
    if (catalog_.techniques().size() < 2) QFAIL("the program has fewer than two techniques");
    const TechniqueEntry& other = catalog_.techniques()[1];
    const ParamInfo& own = other.groups.front().infos[0];
    document_->editTechnique(other.id);
    QVERIFY(link_.takeCalls().front().startsWith(QString::fromStdString("technique " + other.id)));
    const std::string value = own.type == ParamType::Enum ? std::string(own.values.back().name) : defaultText(own);
    document_->editParameters({{own.key(), value}}, "own");
    const auto before = document_->preset().parameters;
    document_->editTechnique("none");
    for (const auto& [key, text] : document_->preset().parameters) QVERIFY(key.rfind(other.id + ".", 0) != 0);
    link_.takeCalls();
    document_->undoStack().undo();
    QCOMPARE(document_->preset().technique, other.id);
    QCOMPARE(document_->preset().parameters, before);
    QVERIFY(link_.takeCalls().front().contains(QString::fromStdString(own.key() + "=" + value)));
  }

  void theCameraStaysWhenEditsAreUndone() {
    edit("128");
    Camera c;
    c.position = vec3(1, 2, 3);
    document_->moveCamera(c);
    document_->undoStack().undo();
    QVERIFY(document_->preset().camera.has_value());
    QCOMPARE(document_->preset().camera->position.y, 2.0f);
  }

  void savingClearsTheMarkAndUndoSetsItAgain() {
    edit("128");
    document_->save("/tmp/some.json");
    QVERIFY(!document_->modified());
    document_->undoStack().undo();
    QVERIFY(document_->modified());
    QCOMPARE(document_->path(), QString("/tmp/some.json"));  // saving is not undone
    QVERIFY(!link_.takeCalls().join(' ').contains("load"));
  }

  void aRefusedEditGivesWayToTheSessions() {
    edit("128");
    emit link_.failed("no", ErrorKind::BadInput);
    QVERIFY(link_.takeCalls().contains("request preset"));
    Preset p = document_->preset();
    p.parameters.clear();
    const quint64 ticket = link_.lastTicket;
    emit link_.presetIs(p, ticket);
    QVERIFY(document_->preset().parameters.empty());
    // An answer that an edit has overtaken is left.
    emit link_.failed("no", ErrorKind::BadInput);
    const quint64 late = link_.lastTicket;
    edit("256");
    emit link_.presetIs(p, late);
    QCOMPARE(document_->parameter(kKey), std::string("256"));
  }

  void openingIsAStepThatTurnsBack() {
    edit("128");
    Preset other;
    other.technique = "none";
    other.scene = "furnace_box_050";
    emit link_.opened(other, "furnace_box_050");
    QCOMPARE(document_->preset().scene, std::string("furnace_box_050"));
    link_.takeCalls();
    document_->undoStack().undo();
    QCOMPARE(link_.takeCalls(), QStringList{"load cornell_box"});
    QCOMPARE(document_->parameter(kKey), std::string("128"));
  }

  void exposureAndViewAreSteps() {
    hl::Display d = document_->preset().display;
    d.exposure = 0.5f;
    document_->editDisplay(d, "exposure");
    d.view = "indirect";
    document_->editDisplay(d, "view");
    QCOMPARE(document_->undoStack().count(), 2);
    document_->undoStack().undo();
    QCOMPARE(document_->preset().display.view, std::string("final"));
    QCOMPARE(document_->preset().display.exposure, 0.5f);
  }

  void lightsTurnBackToTheScenes() {
    auto scene = std::make_shared<Scene>();
    scene->name = "cornell_box";
    scene->hash = "a";
    scene->cameras.resize(1);
    scene->pointLights.push_back({"lamp", vec3(0, 1, 0), vec3(2)});
    auto frame = std::make_shared<FrameResult>();
    frame->scene = scene;
    frame->preset = document_->preset();
    link_.publish(frame);
    LightEdits lights = lightsOf(*scene);
    lights.points[0].intensity = vec3(5);
    document_->editLights(lights, "lamp");
    QCOMPARE(document_->preset().lights->points[0].intensity.x, 5.0f);
    link_.takeCalls();
    document_->undoStack().undo();
    QVERIFY(!document_->preset().lights);
    QCOMPARE(link_.takeCalls(), QStringList{"lights"});
  }
};

}  // namespace

QTEST_MAIN(DocumentTest)
#include "document_test.moc"
