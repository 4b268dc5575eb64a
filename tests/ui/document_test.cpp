// Edits, undo and redo, and what of it reaches the session.
#include <QPushButton>
#include <QTest>

#include "fake_link.h"
#include "ui/document.h"
#include "ui/rebuild_bar.h"

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

  static RebuildForecast longRebuild() {
    RebuildForecast f;
    f.rebuilds = true;
    f.seconds = 12;
    f.work.rays = 1.2e8, f.work.bytes = 2.7e7, f.work.bytesBefore = 2.34e8, f.work.bytesMore = 1.1e7;
    f.anew = {"lightmap", "placement", "transport"};
    f.parts = {{"rays", 11}, {"preparation", 1}};
    return f;
  }
  void withSrp() {
    Preset p;
    p.technique = "srp";
    emit link_.opened(p, {});
    link_.takeCalls();
  }

  void aForecastThatWasCancelledIsNoYes() {
    withSrp();
    RebuildBar bar(*document_);
    RebuildForecast f;
    f.rebuilds = f.cancelled = true;
    link_.forecast = f;
    document_->editParameters({{"srp.sh_order", "6"}}, "order");
    QCOMPARE(link_.takeCalls(), QStringList{});
    QVERIFY(document_->pendingRebuild().waits());
    QVERIFY(bar.isVisibleTo(nullptr));
    bar.rebuildButton()->click();
    QVERIFY(!document_->pendingRebuild().waits());
  }
  void aLongRebuildWaitsToBeAskedFor() {
    withSrp();
    RebuildBar bar(*document_);
    link_.forecast = longRebuild();
    document_->editParameters({{"srp.sh_order", "6"}}, "order");
    QCOMPARE(link_.takeCalls(), QStringList{});
    QCOMPARE(link_.forecastOf, (std::map<std::string, std::string>{{"srp.sh_order", "6"}}));
    QCOMPARE(document_->parameter("srp.sh_order"), std::string("6"));
    QVERIFY(bar.isVisibleTo(nullptr));
    QVERIFY2(bar.text().endsWith(QString::fromStdString(forecastText(longRebuild()))), "the command line's words");
    for (const char* part : {"lightmap, placement, transport: about 12 s", "120 M rays", "27 MB", "at most 11 MB more", "234 MB before"}) QVERIFY2(bar.text().contains(part), qPrintable(bar.text()));
    // Live ones go on meanwhile, and a second one joins the first.
    document_->editParameters({{"srp.least_valid", "0.7"}}, "live");
    QCOMPARE(link_.takeCalls(), QStringList{"param srp.least_valid=0.7"});
    document_->editParameters({{"srp.k", "4"}}, "k");
    QCOMPARE(link_.forecastOf.size(), size_t(2));
    QCOMPARE(link_.takeCalls(), QStringList{});
    bar.rebuildButton()->click();
    QCOMPARE(link_.takeCalls(), (QStringList{"param srp.k=4", "param srp.sh_order=6"}));
    QVERIFY(!document_->pendingRebuild().waits());
    QVERIFY(!bar.isVisibleTo(nullptr));
  }

  void whatWaitsIsRevertedToWhatTheSessionHas() {
    withSrp();
    RebuildBar bar(*document_);
    link_.forecast = longRebuild();
    document_->editParameters({{"srp.sh_order", "6"}}, "order");
    document_->editParameters({{"srp.sh_order", "7"}}, "order");
    document_->editProbes(std::vector<vec3>{{1, 2, 3}}, true, "probes");
    QCOMPARE(link_.takeCalls(), QStringList{});
    bar.revertButton()->click();
    QCOMPARE(link_.takeCalls(), QStringList{});
    QVERIFY(!document_->pendingRebuild().waits());
    QVERIFY(document_->preset().parameters.empty());
    QVERIFY(!document_->preset().probes);
    document_->undoStack().undo();  // of the revert
    QCOMPARE(document_->parameter("srp.sh_order"), std::string("7"));
    QVERIFY(document_->pendingRebuild().waits("srp.sh_order"));
    document_->pendingRebuild().make();
    QCOMPARE(link_.takeCalls(), (QStringList{"probes 1", "param probes.placement=manual", "param srp.sh_order=7"}));
    // Undone by hand to where it was: nothing waits.
    document_->editParameters({{"srp.k", "4"}}, "k");
    document_->undoStack().undo();
    QVERIFY(!document_->pendingRebuild().waits());
    QCOMPARE(link_.takeCalls(), QStringList{});
  }

  void aShortOneIsMadeAtOnceAndARefusedOneNot() {
    withSrp();
    RebuildBar bar(*document_);
    link_.forecast = longRebuild();
    link_.forecast->seconds = 0.5;
    document_->editParameters({{"srp.sh_order", "2"}}, "order");
    QCOMPARE(link_.takeCalls(), QStringList{"param srp.sh_order=2"});
    link_.forecast->refused = "srp.probe_rays: too few";
    document_->editParameters({{"srp.sh_order", "8"}}, "order");
    QCOMPARE(link_.takeCalls(), QStringList{});
    QVERIFY(bar.text().contains("too few"));
    QVERIFY(!bar.rebuildButton()->isEnabled());
    // An answer that comes late is of something else.
    link_.silent = true;
    document_->editParameters({{"srp.sh_order", "3"}}, "order");
    const quint64 late = link_.forecastTicket;
    document_->editParameters({{"srp.sh_order", "4"}}, "order");
    link_.forecast->refused.clear();
    emit link_.forecastIs(*link_.forecast, late);
    QCOMPARE(link_.takeCalls(), QStringList{});
    QTRY_VERIFY(bar.text().contains("being estimated"));
    emit link_.forecastIs(*link_.forecast, link_.forecastTicket);
    QCOMPARE(link_.takeCalls(), QStringList{"param srp.sh_order=4"});
    // With another technique everything is made anyway; a file that is opened brings its own.
    document_->editParameters({{"lightmap.resolution", "64"}}, "lightmap");
    document_->editTechnique("radiosity");
    QCOMPARE(link_.takeCalls().front(), QString("param lightmap.resolution=64"));
    document_->editParameters({{"lightmap.resolution", "32"}}, "lightmap");
    emit link_.opened(Preset{}, {});
    QVERIFY(!document_->pendingRebuild().waits());
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
