#include "ui/plot_export.h"

#include <qcustomplot.h>

#include <QBuffer>
#include <QFileDialog>
#include <QFileInfo>
#include <QMenu>
#include <QMessageBox>
#include <QPageSize>
#include <QPdfWriter>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "ui/background.h"
#include "ui/plot_style.h"

namespace hl::ui {
namespace {

constexpr double kPointsPerInch = 72;

/// Black on white while this lives. The owner's changeEvent restyles the plot.
class PrintColours {
 public:
  explicit PrintColours(QWidget& owner) : owner_(owner), before_(owner.palette()), own_(owner.testAttribute(Qt::WA_SetPalette)) {
    QPalette print = before_;
    for (const auto role : {QPalette::Base, QPalette::Window, QPalette::AlternateBase}) print.setColor(role, Qt::white);
    for (const auto role : {QPalette::Text, QPalette::WindowText}) print.setColor(role, Qt::black);
    owner_.setPalette(print);
  }
  ~PrintColours() { owner_.setPalette(own_ ? before_ : QPalette()); }
  PrintColours(const PrintColours&) = delete;
  PrintColours& operator=(const PrintColours&) = delete;

 private:
  QWidget& owner_;
  QPalette before_;
  bool own_;
};

}  // namespace

QByteArray plotPng(QCustomPlot& plot, QWidget& owner, QSize size, const QMap<QString, QString>& texts) {
  const PrintColours print(owner);
  settleLayout(plot, size);
  QImage image = plot.toPixmap(size.width(), size.height(), kPlotPngScale).toImage().convertToFormat(QImage::Format_RGB888);
  for (auto it = texts.begin(); it != texts.end(); ++it) image.setText(it.key(), it.value());
  QByteArray bytes;
  QBuffer buffer(&bytes);
  if (image.isNull() || !image.save(&buffer, "PNG")) throw Error(ErrorKind::Run, "the plot's picture could not be made");
  return bytes;
}

QByteArray plotPdf(QCustomPlot& plot, QWidget& owner, QSize size, const QString& title) {
  const PrintColours print(owner);
  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  {
    QPdfWriter writer(&buffer);
    writer.setTitle(title);
    writer.setCreator(QStringLiteral("halflight"));
    // The device's resolution is the plot's own, so that fonts, which are in points, are as large as on the screen.
    const int dpi = plot.logicalDpiY();
    writer.setResolution(dpi);
    writer.setPageMargins(QMarginsF(0, 0, 0, 0));
    writer.setPageSize(QPageSize(QSizeF(size) * kPointsPerInch / dpi, QPageSize::Point, QString(), QPageSize::ExactMatch));
    QCPPainter painter(&writer);
    if (!painter.isActive()) throw Error(ErrorKind::Run, "the plot's PDF could not be made");
    painter.setMode(QCPPainter::pmVectorized);
    settleLayout(plot, size);
    plot.toPainter(&painter, size.width(), size.height());
  }
  return bytes;
}

PlotExport::PlotExport(QCustomPlot& plot, QWidget& owner, QString name, std::function<std::string()> csv)
    : QObject(&owner), plot_(plot), owner_(owner), name_(std::move(name)), csv_(std::move(csv)) {
  worker_.setMaxThreadCount(1);
  plot_.setContextMenuPolicy(Qt::CustomContextMenu);
  connect(&plot_, &QWidget::customContextMenuRequested, this, &PlotExport::openMenu);
  connect(this, &PlotExport::refused, this, [this](const QString& why) {
    auto* box = new QMessageBox(QMessageBox::Warning, tr("Export a plot"), why, QMessageBox::Ok, &owner_);
    box->setAttribute(Qt::WA_DeleteOnClose);
    box->open();
  });
}

PlotExport::~PlotExport() { worker_.waitForDone(); }

void PlotExport::openMenu(QPoint at) {
  auto* menu = new QMenu(&plot_);
  menu->setAttribute(Qt::WA_DeleteOnClose);
  if (showEverything) {
    menu->addAction(tr("Show everything"), this, [this] { showEverything(); });
    menu->addSeparator();
  }
  menu->addAction(tr("Save as PNG..."), this, [this] { choosePath(QStringLiteral("png"), tr("Picture (*.png)")); });
  menu->addAction(tr("Save as PDF..."), this, [this] { choosePath(QStringLiteral("pdf"), tr("PDF (*.pdf)")); });
  menu->addAction(tr("Save the data as CSV..."), this, [this] { choosePath(QStringLiteral("csv"), tr("Table (*.csv)")); });
  menu->popup(plot_.mapToGlobal(at));
}

void PlotExport::choosePath(const QString& extension, const QString& kind) {
  auto* dialog = new QFileDialog(&owner_, tr("Export a plot"), QString(), kind);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setDefaultSuffix(extension);
  dialog->selectFile(name_ + QLatin1Char('.') + extension);
  connect(dialog, &QFileDialog::fileSelected, this, &PlotExport::write);
  dialog->open();
}

void PlotExport::write(const QString& path) {
  QByteArray bytes;
  try {
    const QString extension = QFileInfo(path).suffix().toLower();
    if (extension == QLatin1String("png")) {
      bytes = plotPng(plot_, owner_, plot_.size());
    } else if (extension == QLatin1String("pdf")) {
      bytes = plotPdf(plot_, owner_, plot_.size(), name_);
    } else if (extension == QLatin1String("csv")) {
      bytes = QByteArray::fromStdString(csv_());
    } else {
      throw badInput(path.toStdString() + ": plots are written as .png, .pdf or .csv");
    }
  } catch (const std::exception& e) {
    emit refused(QString::fromUtf8(e.what()));
    return;
  }
  worker_.start([this, path, bytes] {
    giveWay();
    QString why;
    try {
      writeFileAtomically(path.toStdString(), {bytes.data(), static_cast<size_t>(bytes.size())});
    } catch (const std::exception& e) {
      why = QString::fromUtf8(e.what());
    }
    QMetaObject::invokeMethod(this, [this, path, why] { why.isEmpty() ? emit written(path) : emit refused(why); }, Qt::QueuedConnection);
  });
}

}  // namespace hl::ui
