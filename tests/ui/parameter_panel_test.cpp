// The parameter panel, generated from a group declared here and nowhere else.
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QSignalSpy>
#include <QSlider>
#include <QTest>
#include <QToolButton>

#include "ui/parameter_field.h"
#include "ui/parameter_panel.h"
#include "ui/parameter_row.h"

namespace {

using namespace hl;
using namespace hl::ui;

constexpr EnumValue kColours[] = {{"red", "the warm one"}, {"deep_blue", "the cold one"}};
const ParamInfo kInfos[] = {
    {"test", "count", ParamType::Int, 64, 1, 4096, 16, 1024, ParamScale::Log, Effect::Reset, "rays", "How many rays.", {}, 0},
    {"test", "radius", ParamType::Float, 0.5, 0, 10, 0, 1, ParamScale::Linear, Effect::Rebuild, "m", "How far.", {}, 4},
    {"test", "on", ParamType::Bool, 1, 0, 1, 0, 1, ParamScale::Linear, Effect::Live, "", "Whether at all.", {}, 8},
    {"test", "colour", ParamType::Enum, 0, 0, 1, 0, 1, ParamScale::Linear, Effect::Live, "", "Which.", kColours, 12},
};
const ParamInfo kOther[] = {
    {"second", "margin", ParamType::Int, 2, 0, 16, 0, 8, ParamScale::Linear, Effect::Rebuild, "texels", "Kept free.", {}, 0},
};

class ParameterPanelTest : public QObject {
  Q_OBJECT

  std::unique_ptr<ParameterPanel> panel_;
  std::vector<std::pair<std::map<std::string, std::string>, quint64>> edits_;

  std::string only() const { return edits_.size() == 1 && edits_[0].first.size() == 1 ? edits_[0].first.begin()->first + "=" + edits_[0].first.begin()->second : "?"; }

 private slots:
  void init() {
    panel_ = std::make_unique<ParameterPanel>();
    panel_->setGroups({{"test", "Test", kInfos}, {"second", "Second", kOther}});
    edits_.clear();
    connect(panel_.get(), &ParameterPanel::edited, this, [this](const auto& texts, quint64 drag) { edits_.push_back({texts, drag}); });
    panel_->resize(360, 400);
    panel_->show();
  }

  void everyDeclarationHasItsRow() {
    QVERIFY(panel_->row("test.count")->slider() && panel_->row("test.count")->field());
    QVERIFY(panel_->row("test.on")->tick());
    QCOMPARE(panel_->row("test.colour")->list()->count(), 2);
    QCOMPARE(panel_->row("test.colour")->list()->itemText(1), QString("Deep blue"));
    QVERIFY(!panel_->row("test.nothing"));
    const QString tip = panel_->row("test.count")->field()->toolTip();
    QVERIFY(tip.contains("test.count") && tip.contains("How many rays.") && tip.contains("4096") && tip.contains("64"));
    QVERIFY(panel_->row("test.radius")->nameLabel()->text().contains("[m]"));
  }

  void showsDefaultsAndGivenValues() {
    QCOMPARE(panel_->row("test.count")->field()->value(), 64.0);
    panel_->setValues({{"test.count", "128"}, {"test.colour", "deep_blue"}, {"test.on", "false"}});
    QCOMPARE(panel_->row("test.count")->field()->value(), 128.0);
    QCOMPARE(panel_->row("test.colour")->list()->currentIndex(), 1);
    QVERIFY(!panel_->row("test.on")->tick()->isChecked());
    QVERIFY(edits_.empty());  // showing is no edit
    panel_->setValues({});
    QCOMPARE(panel_->row("test.count")->field()->value(), 64.0);
  }

  void typedValuesAreLimitedAndSaidSo() {
    ParameterField* field = panel_->row("test.count")->field();
    QSignalSpy limited(field, &ParameterField::limited);
    field->setFocus();
    field->selectAll();
    QTest::keyClicks(field, "5000");
    QTest::keyClick(field, Qt::Key_Return);
    QCOMPARE(field->value(), 4096.0);
    QCOMPARE(only(), std::string("test.count=4096"));
    QCOMPARE(limited.size(), 1);
    QVERIFY(limited[0][0].toString().contains("5000"));
    // The hard range reaches beyond the slider's.
    QCOMPARE(panel_->row("test.count")->slider()->value(), panel_->row("test.count")->slider()->maximum());
  }

  void typedNumbersKeepTheirDigits() {
    ParameterField* field = panel_->row("test.radius")->field();
    field->setFocus();
    field->selectAll();
    QTest::keyClicks(field, "1.25e-4");
    QTest::keyClick(field, Qt::Key_Return);
    QCOMPARE(edits_.size(), size_t(1));
    QCOMPARE(std::stof(edits_[0].first.at("test.radius")), 1.25e-4f);
  }

  void nonsenseChangesNothing() {
    ParameterField* field = panel_->row("test.radius")->field();
    field->setFocus();
    field->selectAll();
    QTest::keyClicks(field, "e-");
    QTest::keyClick(field, Qt::Key_Return);
    QCOMPARE(field->value(), 0.5);
    QVERIFY(edits_.empty());
  }

  void sliderCoversTheSoftRange() {
    QSlider* slider = panel_->row("test.count")->slider();
    slider->setValue(slider->maximum());
    QCOMPARE(panel_->row("test.count")->text(), std::string("1024"));
    slider->setValue(slider->maximum() / 2);
    QCOMPARE(panel_->row("test.count")->text(), std::string("128"));  // the geometric middle of 16 and 1024
    slider->setValue(0);
    QCOMPARE(panel_->row("test.count")->text(), std::string("16"));
  }

  void aDragHasOneNumber() {
    QSlider* slider = panel_->row("test.radius")->slider();
    const auto drag = [&](std::initializer_list<int> positions) {
      slider->setSliderDown(true);
      for (const int p : positions) slider->setSliderPosition(p);
      slider->setSliderDown(false);
    };
    drag({10, 20, 30});
    drag({40, 50});
    QCOMPARE(edits_.size(), size_t(5));
    QVERIFY(edits_[0].second != 0);
    QCOMPARE(edits_[2].second, edits_[0].second);
    QVERIFY(edits_[3].second != edits_[0].second);
    QCOMPARE(edits_[4].second, edits_[3].second);
    slider->setValue(70);  // by a key: a step of its own
    QCOMPARE(edits_.back().second, quint64(0));
  }

  void boldAndResetTellWhatDiffers() {
    ParameterRow* row = panel_->row("test.radius");
    QVERIFY(row->isDefault() && !row->nameLabel()->text().contains("<b>") && row->resetButton()->isHidden());
    QVERIFY(!panel_->groupResetButton("test")->isEnabled());
    panel_->setValues({{"test.radius", "0.75"}});
    QVERIFY(!row->isDefault() && row->nameLabel()->text().contains("<b>") && !row->resetButton()->isHidden());
    QVERIFY(panel_->groupResetButton("test")->isEnabled());
    QVERIFY(!panel_->groupResetButton("second")->isEnabled());
    row->resetButton()->click();
    QCOMPARE(only(), std::string("test.radius=0.5"));
    QVERIFY(row->isDefault() && !row->nameLabel()->text().contains("<b>"));
  }

  void groupResetIsOneEdit() {
    panel_->setValues({{"test.radius", "0.75"}, {"test.on", "false"}, {"second.margin", "5"}});
    panel_->groupResetButton("test")->click();
    QCOMPARE(edits_.size(), size_t(1));
    QCOMPARE(edits_[0].first, (std::map<std::string, std::string>{{"test.radius", "0.5"}, {"test.on", "true"}}));
    QVERIFY(!panel_->row("second.margin")->isDefault());
  }

  void searchLooksAtNamesHelpUnitsAndValues() {
    const auto shown = [&] {
      QStringList names;
      for (const char* key : {"test.count", "test.radius", "test.on", "test.colour", "second.margin"})
        if (panel_->row(key)->nameLabel()->isVisible()) names << key;
      return names;
    };
    QCOMPARE(shown().size(), 5);
    panel_->searchBox()->setText("RAYS");
    QCOMPARE(shown(), QStringList{"test.count"});
    panel_->searchBox()->setText("cold");  // a value's help
    QCOMPARE(shown(), QStringList{"test.colour"});
    panel_->searchBox()->setText("kept texels");  // words in any order
    QCOMPARE(shown(), QStringList{"second.margin"});
    panel_->searchBox()->setText("zzz");
    QCOMPARE(shown(), QStringList{});
    panel_->searchBox()->clear();
    QCOMPARE(shown().size(), 5);
  }

  void wheelScrollsThePanelNotTheValues() {
    QSlider* slider = panel_->row("test.count")->slider();
    slider->clearFocus();
    QWheelEvent wheel(QPointF(5, 5), slider->mapToGlobal(QPointF(5, 5)), {}, {0, 120}, Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase, false);
    QCoreApplication::sendEvent(slider, &wheel);
    QVERIFY(edits_.empty());
  }
};

}  // namespace

QTEST_MAIN(ParameterPanelTest)
#include "parameter_panel_test.moc"
