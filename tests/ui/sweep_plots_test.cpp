// Plots of a sweep that was really run: what is drawn, where, and what a hand does to it.
#include "ui/sweep_plots.h"

#include <qcustomplot.h>

#include <QComboBox>
#include <QMenu>
#include <QSignalSpy>
#include <cmath>

#include "tests/ui/tiny_sweep.h"
#include "ui/convergence_plot.h"
#include "ui/error_plot.h"
#include "ui/parallel_plot.h"
#include "ui/pass_bars.h"
#include "ui/pass_stack_plot.h"
#include "ui/plot_export.h"
#include "ui/plot_style.h"
#include "ui/speed_error_plot.h"

namespace {

using namespace hl;
using namespace hl::ui;

constexpr QSize kSize(720, 460);

QStringList legendOf(QCustomPlot& plot) {
  QStringList out;
  for (int i = 0; i < plot.legend->itemCount(); ++i)
    if (auto* item = qobject_cast<QCPPlottableLegendItem*>(plot.legend->item(i))) out << item->plottable()->name();
  return out;
}

/// Largest difference of a channel.
int differ(QColor a, QColor b) { return std::max({std::abs(a.red() - b.red()), std::abs(a.green() - b.green()), std::abs(a.blue() - b.blue())}); }

/// Of `value` along an axis, by the axis's ends alone.
double along(double value, const QCPRange& range, double from, double to, bool logarithmic) {
  const auto scaled = [&](double v) { return logarithmic ? std::log10(v) : v; };
  return from + (scaled(value) - scaled(range.lower)) / (scaled(range.upper) - scaled(range.lower)) * (to - from);
}

class SweepPlotsTest : public QObject {
  Q_OBJECT

  QTemporaryDir folder_;
  std::shared_ptr<const SweepView> view_;

  template <class Plot>
  QImage picture(Plot& plot, const PlotChoice& choice) {
    plot.resize(kSize);
    plot.setView(view_, choice);
    plot.drawNow();
    settleLayout(plot.plot(), kSize);
    return plot.plot().toPixmap(kSize.width(), kSize.height()).toImage();
  }
  const Front& summaryFront(FrontAxis axis, const std::string& reference) const {
    for (const Front& f : view_->summary.fronts)
      if (f.axis == axis && f.reference == reference && f.problem == 0) return f;
    throw std::runtime_error("no such front");
  }
  std::shared_ptr<SweepView> with(const std::function<void(SweepView&)>& change) const {
    auto v = std::make_shared<SweepView>(*view_);
    change(*v);
    v->summary = summarise(v->results);
    return v;
  }

 private slots:
  void initTestCase() {
    view_ = test::runTinySweep(folder_.filePath("sweep").toStdString());
    QCOMPARE(view_->results.configurations.size(), size_t(5));
    QCOMPARE(view_->results.done(), size_t(10));
    QCOMPARE(view_->results.failed(), size_t(0));
  }

  void everyConfigurationLiesWhereItsValuesSay() {
    PassPalette colours;
    SpeedErrorPlot plot(colours);
    for (const FrontAxis axis : {FrontAxis::Total, FrontAxis::Frame, FrontAxis::Amortised}) {
      const QImage image = picture(plot, {0, "full", "relmse", axis});
      QCOMPARE(plot.nothing(), QString());
      QCOMPARE(plot.marks().size(), size_t(5));
      const QRect rect = plot.plot().axisRect()->rect();
      QCOMPARE(plot.plot().xAxis->scaleType(), QCPAxis::stLogarithmic);
      QCOMPARE(plot.plot().yAxis->scaleType(), QCPAxis::stLogarithmic);
      for (const PlotMark& m : plot.marks()) {
        const ConfigurationSummary& c = view_->summary.configurations[m.configuration];
        QCOMPARE(m.x, costOf(c, axis, 60).median);
        double error = 0;
        for (const ErrorSummary& e : c.errors)
          if (e.reference == "full" && e.metric == "relmse" && e.component == "indirect" && e.target == "image" && e.roi.empty()) error = e.value.mean;
        QVERIFY(error > 0);
        QCOMPARE(m.y, error);
        const QPointF at = plot.pixelOf(m);
        QVERIFY(std::abs(at.x() - along(m.x, plot.plot().xAxis->range(), rect.left(), rect.left() + rect.width(), true)) < 1.5);
        QVERIFY(std::abs(at.y() - along(m.y, plot.plot().yAxis->range(), rect.top() + rect.height(), rect.top(), true)) < 1.5);
        QVERIFY(rect.contains(at.toPoint()));
        for (const FrontPoint& p : plot.front().points)
          if (p.configuration == m.configuration && p.place == FrontPlace::On)
            QVERIFY2(differ(image.pixelColor(at.toPoint()), colours.of(view_->results.configurations[m.configuration].preset.technique)) < 40, qPrintable(image.pixelColor(at.toPoint()).name()));
      }
    }
  }

  void theFrontIsTheSummarys() {
    PassPalette colours;
    SpeedErrorPlot plot(colours);
    for (const FrontAxis axis : {FrontAxis::Total, FrontAxis::Frame, FrontAxis::Amortised}) {
      picture(plot, {0, "full", "relmse", axis});
      const Front& front = summaryFront(axis, "full");
      QCPGraph* line = nullptr;
      for (int i = 0; i < plot.plot().graphCount(); ++i)
        if (plot.plot().graph(i)->name() == "Pareto front") line = plot.plot().graph(i);
      QVERIFY(line);
      std::vector<std::pair<double, double>> drawn, expected;
      for (const QCPGraphData& p : *line->data()) drawn.emplace_back(p.key, p.value);
      for (const FrontPoint& p : front.points)
        if (p.place == FrontPlace::On) expected.emplace_back(p.point.cost, p.point.error);
      QVERIFY(!expected.empty());
      QCOMPARE(drawn, expected);
    }
  }

  void errorBarsAreTheIntervalAndThePercentiles() {
    PassPalette colours;
    SpeedErrorPlot plot(colours);
    picture(plot, {0, "full", "relmse", FrontAxis::Total});
    size_t checked = 0;
    for (int i = 0; i < plot.plot().plottableCount(); ++i) {
      const auto* bars = qobject_cast<QCPErrorBars*>(plot.plot().plottable(i));
      if (!bars || bars->dataPlottable()->name().startsWith("path")) continue;
      const auto* graph = qobject_cast<QCPGraph*>(bars->dataPlottable());
      for (int k = 0; k < graph->dataCount(); ++k)
        for (const FrontPoint& p : plot.front().points) {
          if (p.point.cost != graph->data()->at(k)->key) continue;
          const Spread ms = view_->summary.configurations[p.configuration].totalMs;
          const QCPErrorBarsData& d = bars->data()->at(k);
          const bool time = bars->errorType() == QCPErrorBars::etKeyError;
          QCOMPARE(d.errorMinus, time ? ms.median - ms.p5 : p.point.halfWidth);
          QCOMPARE(d.errorPlus, time ? ms.p95 - ms.median : p.point.halfWidth);
          ++checked;
        }
    }
    QCOMPARE(checked, size_t(10));
  }

  void thePathTracerHasACurveOfItsOwn() {
    PassPalette colours;
    SpeedErrorPlot plot(colours);
    picture(plot, {0, "full", "relmse", FrontAxis::Total});
    QVERIFY(!plot.tracers().empty());
    size_t points = 0;
    for (const TracerCurve& c : plot.tracers()) {
      points += c.points.size();
      QVERIFY(std::is_sorted(c.points.begin(), c.points.end(), [](const CostPoint& a, const CostPoint& b) { return a.cost < b.cost; }));
    }
    QVERIFY(points > 0);
    QVERIFY(legendOf(plot.plot()).filter("path tracer").size() == static_cast<qsizetype>(plot.tracers().size()));
    picture(plot, {0, "full", "relmse", FrontAxis::Memory});
    QVERIFY(plot.tracers().empty());  // it has no memory to compare
    QVERIFY(legendOf(plot.plot()).filter("path tracer").isEmpty());
  }

  void whatHasNoPlaceOnLogarithmicAxesIsSaid() {
    PassPalette colours;
    SpeedErrorPlot plot(colours);
    picture(plot, {0, "full", "relmse", FrontAxis::Memory});  // direct light alone takes none
    QCOMPARE(plot.marks().size(), size_t(4));
    QVERIFY2(plot.note().contains("above 0: 1."), qPrintable(plot.note()));
    picture(plot, {0, "full", "psnr", FrontAxis::Total});
    QCOMPARE(plot.plot().yAxis->scaleType(), QCPAxis::stLinear);
    QVERIFY(plot.plot().yAxis->rangeReversed());  // more decibels are better, and better is lower
    QVERIFY(plot.marks().front().y > 0 && plot.marks().front().y < 100);
  }

  void nothingIsSaidAndNotDrawn() {
    PassPalette colours;
    SpeedErrorPlot plot(colours);
    const QImage image = picture(plot, {0, "full", "flip", FrontAxis::Total});
    QVERIFY2(plot.nothing().contains("flip"), qPrintable(plot.nothing()));
    QVERIFY(!plot.plot().xAxis->visible());
    QVERIFY(plot.marks().empty());
    int dark = 0;
    for (int y = 150; y < 320; ++y)
      for (int x = 0; x < image.width(); ++x) dark += image.pixelColor(x, y).lightness() < 100 ? 1 : 0;
    QVERIFY2(dark > 400, qPrintable(QString::number(dark)));  // the words, all of them
    // A sweep of one setting varies nothing; one of direct light alone bakes nothing.
    auto single = with([](SweepView& v) {
      v.results.configurations.resize(5);
      v.results.problems[0].configurations = {4};
      for (Configuration& c : v.results.configurations) c.values.clear();
    });
    ParallelPlot parallel(colours);
    parallel.setView(single, {0, "full", "relmse", FrontAxis::Total});
    parallel.drawNow();
    QVERIFY(!parallel.nothing().isEmpty());
    PassStackPlot work(PassStackPlot::Of::Work, colours);
    work.setView(single, {0, "full", "relmse", FrontAxis::Total});
    work.drawNow();
    QVERIFY(!work.nothing().isEmpty());
  }

  void runsThatAreMissingAreSaid() {
    auto half = with([](SweepView& v) {
      for (size_t i = 0; i < 3; ++i) v.results.runs[i].reset();
    });
    PassPalette colours;
    SpeedErrorPlot plot(colours);
    plot.setView(half, {0, "full", "relmse", FrontAxis::Total});
    plot.drawNow();
    QVERIFY2(plot.note().contains("3 of 10 runs"), qPrintable(plot.note()));
    plot.setView(nullptr, {});
    plot.drawNow();
    QVERIFY(!plot.nothing().isEmpty());
  }

  /// As a hand does it: hover, click, arrow keys, drag, double click; the panel says which configuration is wanted.
  void pointsAreHoveredAndChosen() {
    PassPalette passes;
    SweepPlots panel(passes, nullptr);
    panel.resize(800, 560);
    panel.setView(view_);
    panel.show();
    SpeedErrorPlot& plot = panel.speedError();
    QTRY_COMPARE(plot.marks().size(), size_t(4));  // against matched, direct light alone has no error at all
    plot.plot().replot();  // at once: where things lie is known after it
    QSignalSpy chosen(&panel, &SweepPlots::chosen);
    const auto moveTo = [&](QPointF at, Qt::MouseButtons buttons) {
      QMouseEvent move(QEvent::MouseMove, at, plot.plot().mapToGlobal(at), Qt::NoButton, buttons, {});
      QApplication::sendEvent(&plot.plot(), &move);
    };
    for (const PlotMark& m : std::vector<PlotMark>(plot.marks())) {
      moveTo(plot.pixelOf(m), Qt::NoButton);
      QVERIFY2(plot.plot().toolTip().contains(" ms ("), qPrintable(plot.plot().toolTip()));
      QTest::mouseClick(&plot.plot(), Qt::LeftButton, {}, plot.pixelOf(m).toPoint());
      QVERIFY(!chosen.isEmpty());
      const size_t wanted = chosen.takeLast().at(0).value<size_t>();
      QCOMPARE(plot.selected(), std::optional<size_t>(wanted));
      const PlotMark* hit = nullptr;
      for (const PlotMark& other : plot.marks())
        if (other.configuration == wanted) hit = &other;
      QVERIFY(hit && QLineF(plot.pixelOf(*hit), plot.pixelOf(m)).length() < 2);
    }
    QTest::mouseClick(&plot.plot(), Qt::LeftButton, {}, QPoint(plot.plot().axisRect()->right() - 2, plot.plot().axisRect()->top() + 2));
    QVERIFY(chosen.size() <= 4);
    chosen.clear();
    panel.select(std::nullopt);
    QTest::keyClick(&plot.plot(), Qt::Key_Right);
    QCOMPARE(plot.selected(), std::optional<size_t>(plot.marks()[0].configuration));
    QTest::keyClick(&plot.plot(), Qt::Key_Right);
    QTest::keyClick(&plot.plot(), Qt::Key_Return);
    QCOMPARE(chosen.size(), 1);
    QCOMPARE(chosen[0].at(0).value<size_t>(), plot.marks()[1].configuration);
    for (const SweepPlot* p : panel.plots()) QCOMPARE(p->selected(), std::optional<size_t>(plot.marks()[1].configuration));

    const QCPRange before = plot.plot().xAxis->range();
    const QPoint middle = plot.plot().axisRect()->center();
    QTest::mousePress(&plot.plot(), Qt::LeftButton, {}, middle);
    moveTo(middle + QPoint(60, 0), Qt::LeftButton);
    QTest::mouseRelease(&plot.plot(), Qt::LeftButton, {}, middle + QPoint(60, 0));
    QVERIFY(plot.plot().xAxis->range() != before);
    const QCPRange moved = plot.plot().xAxis->range();
    plot.drawNow();
    QCOMPARE(plot.plot().xAxis->range(), moved);  // new runs do not take the view away
    plot.resetZoom();
    QCOMPARE(plot.plot().xAxis->range(), before);
  }

  void thePanelShowsWhatIsChosen() {
    PassPalette passes;
    SweepPlots panel(passes, nullptr);
    panel.resize(800, 560);
    panel.show();
    QTRY_VERIFY(!panel.speedError().nothing().isEmpty());
    panel.setView(view_);
    const auto choose = [&](const char* name, const QString& text) {
      for (QComboBox* box : panel.findChildren<QComboBox*>())
        if (box->accessibleName() == name) {
          box->setCurrentIndex(box->findText(text));
          emit box->activated(box->currentIndex());
          return box->currentIndex() >= 0;
        }
      return false;
    };
    QVERIFY(choose("Reference", "full reference"));
    QVERIFY(choose("Cost", "per frame"));
    QCOMPARE(panel.choice().reference, std::string("full"));
    QTRY_COMPARE(panel.speedError().front().axis, FrontAxis::Frame);
    QTRY_COMPARE(panel.speedError().marks().size(), size_t(5));
    panel.setView(with([](SweepView& v) { v.results.runs[0].reset(); }));
    QCOMPARE(panel.choice().reference, std::string("full"));  // stays
    QCOMPARE(panel.choice().cost, FrontAxis::Frame);
  }

  void everyRunHasItsLineOverTimeAndFrames() {
    for (const auto over : {ConvergencePlot::Over::Time, ConvergencePlot::Over::Frames}) {
      ConvergencePlot plot(over);
      picture(plot, {0, "full", "relmse", FrontAxis::Total});
      QCOMPARE(plot.nothing(), QString());
      QCOMPARE(plot.curves().size(), size_t(10));
      QCOMPARE(plot.plot().xAxis->scaleType(), QCPAxis::stLogarithmic);
      QCOMPARE(plot.plot().yAxis->scaleType(), QCPAxis::stLogarithmic);
      size_t points = 0;
      for (size_t i = 0; i < view_->results.plan.size(); ++i)
        for (const ErrorAt& at : view_->results.runs[i]->convergence)
          for (const ErrorValue& e : at.errors)
            if (e.reference == "full" && e.metric == "relmse" && e.value > 0) {
              ++points;
              const double x = over == ConvergencePlot::Over::Time ? at.ms : at.frames;
              QVERIFY(std::any_of(plot.marks().begin(), plot.marks().end(), [&](const PlotMark& m) { return m.configuration == view_->results.plan[i].configuration && m.x == x && m.y == e.value; }));
              QVERIFY(plot.plot().xAxis->range().contains(x) && plot.plot().yAxis->range().contains(e.value));
            }
      QCOMPARE(plot.marks().size(), points);
      QCOMPARE(QString::fromStdString(plot.csv()).count('\n'), static_cast<qsizetype>(points + 1));
      QCOMPARE(legendOf(plot.plot()).filter("samples").size(), 4);
    }
  }

  void barsAreThePassesInTheirColours() {
    PassPalette colours;
    PassStackPlot plot(PassStackPlot::Of::Frame, colours);
    const QImage image = picture(plot, {0, "full", "relmse", FrontAxis::Total});
    QCOMPARE(plot.nothing(), QString());
    size_t coloured = 0;
    for (const ConfigurationSummary& c : view_->summary.configurations) {
      QVERIFY(!c.passes.empty());
      double sum = 0;
      for (const PassSummary& p : c.passes) {
        sum += p.ms.median;
        for (const PlotMark& m : plot.marks())
          if (m.configuration == c.configuration && m.text.endsWith(QStringLiteral("\n%1: %2 ms").arg(QString::fromStdString(p.name)).arg(p.ms.median, 0, 'g', 4))) {
            const QPoint at = plot.pixelOf(m).toPoint();
            const double width = std::abs(plot.plot().xAxis->coordToPixel(p.ms.median) - plot.plot().xAxis->coordToPixel(0));
            if (width <= 6) continue;  // its middle is then clear of the edges, which are blended
            ++coloured;
            QVERIFY2(differ(image.pixelColor(at), colours.of(p.name)) < 3,
                     qPrintable(QStringLiteral("%1 at %2, %3: %4").arg(QString::fromStdString(p.name)).arg(at.x()).arg(at.y()).arg(image.pixelColor(at).name())));
          }
      }
      QVERIFY(plot.plot().xAxis->range().contains(std::max(sum, c.frameMs.median)));
    }
    QVERIFY(coloured >= 5);
    PassStackPlot work(PassStackPlot::Of::Work, colours);
    picture(work, {0, "full", "relmse", FrontAxis::Total});
    QVERIFY(!work.marks().empty());
    for (const PlotMark& m : work.marks()) QVERIFY(m.configuration < 4);  // direct light alone bakes nothing
    QVERIFY(std::all_of(work.passes().begin(), work.passes().end(), [](const std::string& p) { return p.starts_with("radiosity"); }));
  }

  void parallelCoordinatesHaveListsNamesAndNumbers() {
    PassPalette colours;
    ParallelPlot plot(colours);
    picture(plot, {0, "full", "relmse", FrontAxis::Total});
    QCOMPARE(plot.nothing(), QString());
    QStringList titles;
    for (const ParallelPlot::Column& c : plot.columns()) titles << c.title;
    QCOMPARE(titles.size(), 5);
    QVERIFY(titles.contains("samples") && titles.contains("resolution") && titles.contains("technique") && titles.back() == "relmse");
    const auto& technique = plot.columns()[static_cast<size_t>(titles.indexOf("technique"))];
    QCOMPARE(technique.ticks.size(), size_t(2));
    QVERIFY(technique.places[4] != technique.places[0]);
    const size_t samplesAt = static_cast<size_t>(titles.indexOf("samples"));
    const auto& samples = plot.columns()[samplesAt];
    QVERIFY(std::isnan(samples.places[4]));  // direct light alone has none
    QCOMPARE(plot.marks().size(), size_t(5));
    for (size_t c = 0; c < 4; ++c) QCOMPARE(samples.places[c], view_->results.configurations[c].values.back().second == "64" || view_->results.configurations[c].values.front().second == "64" ? 1.0 : 0.0);
    plot.brush(samplesAt, std::pair(0.5, 1.0));
    for (size_t c = 0; c < 5; ++c) QCOMPARE(plot.isBrushedAway(c), !(samples.places[c] == 1.0));
    plot.brush(samplesAt, std::nullopt);
    QVERIFY(!plot.isBrushedAway(0));
    // A click on a line, and a drag along an axis.
    plot.show();
    QSignalSpy chosen(&plot, &SweepPlot::chosen);
    plot.drawNow();
    plot.plot().replot();
    const double x = 2.5;
    const auto& a = plot.columns()[2].places;
    const auto& b = plot.columns()[3].places;
    QTest::mouseClick(&plot.plot(), Qt::LeftButton, {}, QPointF(plot.plot().xAxis->coordToPixel(x), plot.plot().yAxis->coordToPixel((a[4] + b[4]) / 2)).toPoint());
    QCOMPARE(chosen.size(), 1);
    QCOMPARE(chosen[0].at(0).value<size_t>(), size_t(4));
    const auto on = [&](double place) { return QPointF(plot.plot().xAxis->coordToPixel(static_cast<double>(samplesAt)), plot.plot().yAxis->coordToPixel(place)).toPoint(); };
    QTest::mousePress(&plot.plot(), Qt::LeftButton, {}, on(0.4));
    QTest::mouseRelease(&plot.plot(), Qt::LeftButton, {}, on(1.05));
    QVERIFY(plot.isBrushedAway(4));
    QCOMPARE(chosen.size(), 1);
  }

  void picturesAreForPrintWhateverTheTheme() {
    PassPalette colours;
    SpeedErrorPlot plot(colours);
    QPalette dark;
    for (const auto role : {QPalette::Base, QPalette::Window}) dark.setColor(role, Qt::black);
    for (const auto role : {QPalette::Text, QPalette::WindowText}) dark.setColor(role, Qt::white);
    plot.setPalette(dark);
    const QImage seen = picture(plot, {0, "full", "relmse", FrontAxis::Total});
    QCOMPARE(seen.pixelColor(1, 1), QColor(Qt::black));
    QSignalSpy written(&plot.exporter(), &PlotExport::written), refused(&plot.exporter(), &PlotExport::refused);
    for (const char* name : {"plot.png", "plot.pdf", "plot.csv"}) plot.exporter().write(folder_.filePath(name));
    QTRY_COMPARE(written.size(), 3);
    const QImage saved(folder_.filePath("plot.png"));
    QCOMPARE(saved.size(), plot.plot().size() * 2);
    QCOMPARE(saved.pixelColor(1, 1), QColor(Qt::white));
    QCOMPARE(plot.palette().color(QPalette::Base), QColor(Qt::black));
    QVERIFY(QByteArray::fromStdString(readFile(folder_.filePath("plot.pdf").toStdString())).startsWith("%PDF-"));
    const QString table = QString::fromStdString(readFile(folder_.filePath("plot.csv").toStdString()));
    QCOMPARE(table.count("\nconfiguration,"), 5);
    QCOMPARE(table.count(",on\n"), static_cast<qsizetype>(std::count_if(plot.front().points.begin(), plot.front().points.end(), [](const FrontPoint& p) { return p.place == FrontPlace::On; })));
    plot.exporter().write(folder_.filePath("plot.gif"));
    plot.exporter().write(folder_.filePath("no/such/folder/plot.png"));
    QTRY_COMPARE(refused.size(), 2);
    QVERIFY(refused[0].at(0).toString().contains("plot.gif"));
    QVERIFY(refused[1].at(0).toString().contains("no/such/folder"));
  }

  void theWindowsOtherPlotsExportToo() {
    ErrorPlot errors;
    errors.resize(400, 300);
    std::vector<ConvergencePoint> points;
    for (uint64_t i = 1; i <= 3; ++i) points.push_back({i, static_cast<double>(i) * 1000, static_cast<double>(i) * 1000, {{"matched", "image", "indirect", "relmse", 0.1 / static_cast<double>(i), 0.001, 0, 0, ""}, {"full", "image", "indirect", "relmse", 0.2, 0, 0, 0, ""}}});
    errors.draw(points, "relmse", "indirect", false);
    QCOMPARE(errors.csv(), std::string("seconds,metric,matched,full,noise_floor_matched\n1,relmse,0.1,0.2,0.001\n2,relmse,0.05,0.2,0.001\n3,relmse,0.03333333333333333,0.2,0.001\n"));
    PassPalette colours;
    PassBars bars(colours);
    bars.resize(400, 300);
    bars.add(7, {{"a: one", false, 1.5, 0, ""}, {"b", true, 2, 0, ""}});
    bars.draw();
    QCOMPARE(bars.csv(), std::string("frame,pass,ms\n7,a: one,1.5\n7,b,2\n"));
    QSignalSpy one(&errors.exporter(), &PlotExport::written), two(&bars.exporter(), &PlotExport::written);
    errors.exporter().write(folder_.filePath("errors.png"));
    bars.exporter().write(folder_.filePath("bars.pdf"));
    QTRY_VERIFY(one.size() == 1 && two.size() == 1);
    QVERIFY(!QImage(folder_.filePath("errors.png")).isNull());
    // The menu, by a right click.
    bars.show();
    QContextMenuEvent click(QContextMenuEvent::Mouse, QPoint(50, 50), bars.mapToGlobal(QPoint(50, 50)));
    QApplication::sendEvent(bars.findChild<QCustomPlot*>(), &click);
    QMenu* menu = nullptr;
    QTRY_VERIFY((menu = bars.findChild<QMenu*>()) != nullptr);
    QCOMPARE(menu->actions().size(), 5);  // with "Show everything" and a line below it
    menu->close();
  }
};

}  // namespace

QTEST_MAIN(SweepPlotsTest)
#include "sweep_plots_test.moc"
