#include "ui/figure_dialog.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QFileDialog>
#include <QFormLayout>
#include <QLabel>
#include <QListWidget>
#include <QMetaObject>
#include <QPushButton>
#include <QVBoxLayout>

#include "engine/metrics/metrics.h"
#include "ui/background.h"

namespace hl::ui {
namespace {

QString text(std::string_view s) { return QString::fromUtf8(s.data(), static_cast<qsizetype>(s.size())); }

QListWidgetItem* checkable(QListWidget* list, const QString& name, const QString& id, bool on) {
  auto* item = new QListWidgetItem(name, list);
  item->setData(Qt::UserRole, id);
  item->setFlags(item->flags() | Qt::ItemIsUserCheckable);
  item->setCheckState(on ? Qt::Checked : Qt::Unchecked);
  return item;
}

}  // namespace

FigureDialog::FigureDialog(Compare& compare, Document& document, ImageFeed& feed, QWidget* parent)
    : QDialog(parent), compare_(compare), document_(document), feed_(feed), pictures_(new QListWidget(this)), metrics_(new QListWidget(this)), insets_(new QListWidget(this)),
      component_(new QComboBox(this)), truth_(new QComboBox(this)), message_(new QLabel(this)) {
  setWindowTitle(tr("Export a figure"));
  auto* column = new QVBoxLayout(this);
  auto* form = new QFormLayout;
  for (const CompareSource& s : compare_.sources()) {
    QListWidgetItem* item = checkable(pictures_, s.name, s.id, s.id != QLatin1String("matched"));
    item->setFlags(item->flags() | Qt::ItemIsEditable);
    truth_->addItem(s.name, s.id);
  }
  truth_->insertItem(0, tr("nothing"), QString());
  truth_->setCurrentIndex(truth_->findData(QStringLiteral("full")));
  for (const Compare::Part& p : compare_.parts()) component_->addItem(p.name, static_cast<int>(p.part));
  for (const MetricInfo& m : metricInfos()) checkable(metrics_, text(m.label), text(m.id), m.id == "relmse");
  for (const Region& r : document_.regions()) checkable(insets_, QString::fromStdString(r.name), QString::fromStdString(r.name), true);
  pictures_->setToolTip(tr("In this order; a name is its caption: F2 or a double click changes it, and a drag its place"));
  pictures_->setDragDropMode(QAbstractItemView::InternalMove);
  const auto row = [&](const QString& name, QWidget* w) {
    w->setAccessibleName(QString(name).remove('&'));
    form->addRow(name, w);
  };
  row(tr("&Pictures"), pictures_);
  row(tr("&Of"), component_);
  row(tr("&Metrics"), metrics_);
  row(tr("Measured &against"), truth_);
  row(tr("&Enlarged regions"), insets_);
  column->addLayout(form);
  message_->setWordWrap(true);
  message_->setText(insets_->count() ? QString() : tr("Regions can be drawn in the picture (R)."));
  column->addWidget(message_);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, this);
  export_ = buttons->addButton(tr("E&xport..."), QDialogButtonBox::ActionRole);
  column->addWidget(buttons);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
  connect(export_, &QPushButton::clicked, this, &FigureDialog::choosePath);
  connect(pictures_, &QListWidget::itemChanged, this, &FigureDialog::wantImages);
  connect(component_, &QComboBox::activated, this, &FigureDialog::wantImages);
  connect(truth_, &QComboBox::activated, this, &FigureDialog::wantImages);
  connect(this, &FigureDialog::refused, message_, &QLabel::setText);
  connect(this, &FigureDialog::written, this, [this](const QString& path) { message_->setText(tr("Saved %1").arg(path)); });
  resize(480, 560);
  wantImages();
}

FigureDialog::~FigureDialog() {
  worker_.waitForDone();
  feed_.want(this, {});
}

void FigureDialog::wantImages() {
  std::set<QString> sources;
  for (int i = 0; i < pictures_->count(); ++i)
    if (pictures_->item(i)->checkState() == Qt::Checked) sources.insert(pictures_->item(i)->data(Qt::UserRole).toString());
  if (const QString truth = truth_->currentData().toString(); !truth.isEmpty()) sources.insert(truth);
  feed_.want(this, Compare::imagesOf(sources, part()));
  if (sources.count(QStringLiteral("matched")) || sources.count(QStringLiteral("full"))) emit compare_.referenceNeeded();
}

PicturePart FigureDialog::part() const { return static_cast<PicturePart>(component_->currentData().toInt()); }

FigureSheet FigureDialog::figure() const {
  FigureSheet f;
  const PicturePart of = part();
  for (int i = 0; i < pictures_->count(); ++i) {
    const QListWidgetItem* item = pictures_->item(i);
    if (item->checkState() != Qt::Checked) continue;
    const QString id = item->data(Qt::UserRole).toString();
    f.images.push_back({item->text(), compare_.image(id, of), compare_.frameOf(id), compare_.errorContext(id, truth_->currentData().toString(), of)});
  }
  f.display = document_.preset().display;
  for (int i = 0; i < metrics_->count(); ++i)
    if (metrics_->item(i)->checkState() == Qt::Checked) f.metrics.push_back(metrics_->item(i)->data(Qt::UserRole).toString().toStdString());
  if (const QString truth = truth_->currentData().toString(); !truth.isEmpty()) {
    f.truth = compare_.image(truth, of);
    f.truthName = truth_->currentText();
  }
  const std::vector<Region> regions = document_.regions();
  for (int i = 0; i < insets_->count(); ++i)
    for (const Region& r : regions)
      if (insets_->item(i)->checkState() == Qt::Checked && r.name == insets_->item(i)->data(Qt::UserRole).toString().toStdString()) f.insets.push_back(r);
  return f;
}

void FigureDialog::write(const QString& path) {
  const FigureSheet f = figure();
  if (!truth_->currentData().toString().isEmpty() && !f.truth && !f.metrics.empty()) {
    emit refused(tr("%1 has no picture yet to measure against").arg(truth_->currentText()));
    return;
  }
  export_->setEnabled(false);
  worker_.start([this, f, path] {
    giveWay();
    QString why;
    try {
      writeFigure(f, path.toStdString());
    } catch (const std::exception& e) {
      why = QString::fromUtf8(e.what());
    }
    QMetaObject::invokeMethod(
        this,
        [this, path, why] {
          export_->setEnabled(true);
          why.isEmpty() ? emit written(path) : emit refused(why);
        },
        Qt::QueuedConnection);
  });
}

void FigureDialog::choosePath() {
  auto* dialog = new QFileDialog(this, tr("Export a figure"), QString(), tr("PDF (*.pdf);;PNG (*.png)"));
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setDefaultSuffix(QStringLiteral("pdf"));
  connect(dialog, &QFileDialog::filterSelected, dialog,
          [dialog](const QString& filter) { dialog->setDefaultSuffix(filter.contains(QStringLiteral("*.png")) ? QStringLiteral("png") : QStringLiteral("pdf")); });
  connect(dialog, &QFileDialog::fileSelected, this, &FigureDialog::write);
  dialog->open();
}

}  // namespace hl::ui
