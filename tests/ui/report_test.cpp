// `halflight report` as a program: what it writes of a sweep, whole or half, and what it says of a folder that is none.
#include <QImage>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QProcess>
#include <QRegularExpression>
#include <QSet>

#include "tests/ui/tiny_sweep.h"

namespace {

using namespace hl;
namespace fs = std::filesystem;

struct Answer {
  int code = -1;
  QString out, err;
};

/// Without a display and without a word on how to do without.
Answer report(const QStringList& arguments) {
  QProcess program;
  QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
  for (const char* name : {"QT_QPA_PLATFORM", "DISPLAY", "WAYLAND_DISPLAY"}) environment.remove(name);
  static const QTemporaryDir runtime;  // nobody else's, or Qt says so on stderr
  environment.insert("XDG_RUNTIME_DIR", runtime.path());
  program.setProcessEnvironment(environment);
  program.start(QStringLiteral(HALFLIGHT_PROGRAM), QStringList{"report"} + arguments);
  if (!program.waitForFinished(240'000)) program.kill(), program.waitForFinished();
  return {program.exitStatus() == QProcess::NormalExit ? program.exitCode() : -1, QString::fromUtf8(program.readAllStandardOutput()), QString::fromUtf8(program.readAllStandardError())};
}

QString contentOf(const QString& path) { return QString::fromStdString(readFile(path.toStdString())); }

QStringList columnsOf(const QString& path) { return contentOf(path).section('\n', 0, 0).split(','); }

class ReportTest : public QObject {
  Q_OBJECT

  QTemporaryDir folder_;
  QString sweep_, report_;
  std::shared_ptr<const SweepView> view_;

  QString copyOfSweep(const char* name) const {
    const fs::path to = folder_.filePath(name).toStdString();
    fs::copy(sweep_.toStdString(), to, fs::copy_options::recursive);
    fs::remove_all(to / "report");
    return QString::fromStdString(to.string());
  }

 private slots:
  void initTestCase() {
    sweep_ = folder_.filePath("sweep"), report_ = sweep_ + "/report";
    view_ = test::runTinySweep(sweep_.toStdString());
    QCOMPARE(view_->results.done(), size_t(10));
    const QString before = contentOf(sweep_ + "/report.md");
    const Answer a = report({sweep_});
    QVERIFY2(a.code == 0, qPrintable(a.err));
    QCOMPARE(a.err, QString());
    QVERIFY2(a.out.contains("plots in "), qPrintable(a.out));
    QCOMPARE(contentOf(sweep_ + "/report.md"), before);  // bench's own stays
  }

  void everyPlotIsThereInThreeFormsAndLinked() {
    const QString index = contentOf(report_ + "/report.md");
    QSet<QString> linked;
    static const QRegularExpression link(QStringLiteral("\\]\\(([^)]+)\\)"));
    for (auto it = link.globalMatch(index); it.hasNext();) linked.insert(it.next().captured(1));
    int plots = 0;
    for (const QString& name : QDir(report_).entryList({"*.png"})) {
      ++plots;
      const QString stem = name.chopped(4);
      const QImage image(report_ + '/' + name);
      QVERIFY2(image.width() >= 900 && image.height() >= 400, qPrintable(name));  // twice the plot's own size
      QCOMPARE(image.pixelColor(1, 1), QColor(Qt::white));
      QVERIFY(image.text("Description").contains(QString::fromStdString(view_->results.provenance.device)));
      QSet<QRgb> colours;
      for (int y = 0; y < image.height(); y += 3)
        for (int x = 0; x < image.width(); x += 3) colours.insert(image.pixel(x, y));
      QVERIFY2(colours.size() > 10, qPrintable(name));
      const QByteArray pdf = QByteArray::fromStdString(readFile((report_ + '/' + stem + ".pdf").toStdString()));
      QVERIFY(pdf.startsWith("%PDF-") && pdf.trimmed().endsWith("%%EOF"));
      QCOMPARE(pdf.count("/Type /Page\n"), 1);
      QVERIFY(contentOf(report_ + '/' + stem + ".csv").count('\n') > 1);
      for (const char* extension : {".png", ".pdf", ".csv"}) QVERIFY2(linked.remove(stem + extension), qPrintable(stem + extension));
    }
    QVERIFY2(linked.isEmpty(), qPrintable(QStringList(linked.values()).join(' ')));
    // Against two references: four costs by the first metric, and mse, bias, psnr until settled; error over time and over frames; passes of frame and bake; parallel.
    QCOMPARE(plots, 2 * (4 + 3) + 2 * 2 + 2 + 2);
    QVERIFY(index.contains("Bias and variance"));  // what the sweep says in tables
  }

  void tablesHoldTheSummary() {
    QCOMPARE(contentOf(report_ + "/results.csv"), contentOf(sweep_ + "/results.csv"));
    const QStringList rows = contentOf(report_ + "/speed_error-total_ms-full-relmse.csv").split('\n');
    size_t found = 0;
    for (const Front& f : view_->summary.fronts)
      if (f.axis == FrontAxis::Total && f.reference == "full")
        for (const FrontPoint& p : f.points)
          for (const QString& row : rows)
            if (row.startsWith(QStringLiteral("configuration,%1,").arg(p.configuration)) && row.endsWith(p.place == FrontPlace::On ? ",on" : p.place == FrontPlace::Within ? ",within" : ",off")) ++found;
    QCOMPARE(found, size_t(5));
  }

  void theNotebookIsOneAndNamesColumnsThatAreThere() {
    QJsonParseError error{};
    const QJsonObject book = QJsonDocument::fromJson(contentOf(report_ + "/report.ipynb").toUtf8(), &error).object();
    QCOMPARE(error.error, QJsonParseError::NoError);
    QCOMPARE(book["nbformat"].toInt(), 4);
    QVERIFY(book["nbformat_minor"].isDouble());
    QVERIFY(book["metadata"].toObject()["kernelspec"].toObject()["name"].isString());
    QString code;
    int pictures = 0;
    QSet<QString> ids;
    for (const QJsonValue& value : book["cells"].toArray()) {
      const QJsonObject cell = value.toObject();
      QVERIFY(cell["metadata"].isObject() && cell["source"].isString());
      static const QRegularExpression id(QStringLiteral("^[a-zA-Z0-9_-]{1,64}$"));
      QVERIFY(id.match(cell["id"].toString()).hasMatch());
      QVERIFY(!ids.contains(cell["id"].toString()));
      ids.insert(cell["id"].toString());
      const QString type = cell["cell_type"].toString();
      QVERIFY(type == "markdown" || type == "code");
      QCOMPARE(cell.contains("outputs"), type == "code");
      QCOMPARE(cell.contains("execution_count"), type == "code");
      if (type != "code") continue;
      code += cell["source"].toString() + '\n';
      for (const QJsonValue& output : cell["outputs"].toArray()) {
        QCOMPARE(output.toObject()["output_type"].toString(), QString("display_data"));
        const QByteArray png = QByteArray::fromBase64(output.toObject()["data"].toObject()["image/png"].toString().toLatin1());
        QVERIFY(!QImage::fromData(png, "PNG").isNull());
        ++pictures;
      }
    }
    const int references = static_cast<int>(view_->results.experiment.references.size()), metrics = static_cast<int>(plottedMetrics(view_->results).size());
    QCOMPARE(pictures, references * metrics + 2 * references + 2 + references);  // speed by metric; over time and frames; passes of frame and bake; parallel
    // What it names: columns of its tables, or what it made itself.
    QSet<QString> known;
    for (const char* table : {"results.csv", "convergence.csv", "passes_frame.csv", "passes_work.csv"}) {
      QVERIFY(code.contains(table));
      for (const QString& c : columnsOf(report_ + '/' + table)) known.insert(c);
    }
    const auto each = [&](const char* pattern, const auto& what) {
      const QRegularExpression expression(QString::fromLatin1(pattern));
      for (auto it = expression.globalMatch(code); it.hasNext();) what(it.next().captured(1));
    };
    for (const char* made : {"\\[\"([a-z_0-9.]+)\"\\] = ", "[{ ]\"([a-z_0-9]+)\": ", "([a-z_0-9]+)=\\(\""}) each(made, [&](const QString& name) { known.insert(name); });
    int named = 0;
    each("\\w\\[\"([a-z_0-9.]+)\"\\]", [&](const QString& name) {
      ++named;
      QVERIFY2(known.contains(name), qPrintable(name));
    });
    QVERIFY(named > 20);
    static const QRegularExpression axes(QStringLiteral("AXES = \\[([^\\]]*)\\]"));
    const QStringList keys = axes.match(code).captured(1).remove('"').split(", ");
    QCOMPARE(keys.size(), 2);
    for (const QString& key : keys) QVERIFY2(columnsOf(report_ + "/results.csv").contains(key), qPrintable(key));
  }

  void aHalfFinishedSweepIsDrawnAndWhatIsMissingSaid() {
    const QString half = copyOfSweep("half");
    for (const size_t i : {size_t(1), size_t(7)}) fs::remove(half.toStdString() + "/runs/" + view_->results.plan[i].key + ".json");
    for (const char* table : {"/results.json", "/results.csv", "/report.md", "/convergence.csv"}) fs::remove(half.toStdString() + table);  // as after a kill
    const QString out = folder_.filePath("elsewhere/deep");
    const Answer a = report({half, "--out", out});
    QVERIFY2(a.code == 0, qPrintable(a.err));
    QVERIFY2(a.err.contains("2 of 10 runs are missing"), qPrintable(a.err));
    QVERIFY(contentOf(out + "/report.md").contains("2 of 10 runs are missing"));
    QVERIFY(!QImage(out + "/speed_error-total_ms-full-relmse.png").isNull());
    QVERIFY(!QFile::exists(half + "/report"));
  }

  void whatIsNoFolderOfResultsIsRefusedInOneLine() {
    const auto refused = [&](const QStringList& arguments, const QString& part, int code = 2) {
      const Answer a = report(arguments);
      QVERIFY2(a.code == code, qPrintable(QString::number(a.code) + a.err));
      QVERIFY2(a.err.contains(part), qPrintable(a.err));
      QCOMPARE(a.err.count('\n'), 1);
      QCOMPARE(a.out, QString());
    };
    refused({}, "one folder of results");
    refused({sweep_, sweep_}, "one folder of results");
    refused({folder_.filePath("nowhere")}, "nowhere");
    refused({folder_.path()}, "experiment.json");
    refused({sweep_ + "/results.csv"}, "no folder");
    refused({sweep_, "--out", sweep_}, "own report.md");
    refused({sweep_, "--out", sweep_ + "/results.csv/report"}, "cannot be made");
    const QString damaged = copyOfSweep("damaged");
    writeFileAtomically(damaged.toStdString() + "/results.json", contentOf(sweep_ + "/results.json").left(500).toStdString());
    refused({damaged}, "results.json: damaged");
    writeFileAtomically(damaged.toStdString() + "/results.json", "[1, 2]\n");
    refused({damaged}, "results.json: no table of a sweep");
    writeFileAtomically(damaged.toStdString() + "/experiment.json", "{\"version\": 1");
    refused({damaged}, "experiment.json");
    const QString empty = copyOfSweep("empty");
    fs::remove_all(empty.toStdString() + "/runs");
    refused({empty}, "none of its 10 runs");
  }
};

}  // namespace

QTEST_MAIN(ReportTest)
#include "report_test.moc"
