#include "ui/rebuild_bar.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/document.h"

namespace hl::ui {
namespace {

constexpr int kPatienceMs = 300;

/// In the command line's words.
QString forecastLine(const RebuildForecast& f) {
  const QString text = QString::fromStdString(forecastText(f));
  if (!f.refused.empty()) return RebuildBar::tr("Cannot be: %1").arg(text);
  return text.isEmpty() ? RebuildBar::tr("Rebuild") : RebuildBar::tr("Rebuild: %1").arg(text);
}

QString partsText(const RebuildForecast& f) {
  QString text;
  for (const auto& [name, seconds] : f.parts) text += RebuildBar::tr("%1: %2 s").arg(QString::fromStdString(name)).arg(seconds, 0, 'f', 2) + QStringLiteral("\n");
  return text.trimmed();
}

}  // namespace

RebuildBar::RebuildBar(Document& document, QWidget* parent)
    : QFrame(parent), document_(document), label_(new QLabel(this)), rebuild_(new QPushButton(tr("Re&build"), this)), revert_(new QPushButton(tr("Re&vert"), this)) {
  setFrameShape(QFrame::StyledPanel);
  auto* column = new QVBoxLayout(this);
  label_->setWordWrap(true);
  label_->setTextFormat(Qt::PlainText);
  label_->setAccessibleName(tr("What a rebuild takes"));
  column->addWidget(label_);
  auto* line = new QHBoxLayout;
  line->addStretch(1);
  rebuild_->setToolTip(tr("Precompute with the values as they stand now"));
  revert_->setToolTip(tr("Back to the values that the picture was made with"));
  line->addWidget(rebuild_);
  line->addWidget(revert_);
  column->addLayout(line);
  connect(rebuild_, &QPushButton::clicked, this, [this] { document_.pendingRebuild().make(); });
  connect(revert_, &QPushButton::clicked, this, [this] { document_.revertRebuild(); });
  connect(&document_.pendingRebuild(), &PendingRebuild::changed, this, &RebuildBar::refresh);
  patience_.setSingleShot(true);
  patience_.setInterval(kPatienceMs);
  connect(&patience_, &QTimer::timeout, this, [this] {
    if (!document_.pendingRebuild().waits() || document_.pendingRebuild().forecast()) return;
    label_->setText(tr("Rebuild: being estimated"));
    label_->setToolTip({});
    rebuild_->setEnabled(true);
    setVisible(true);
  });
  refresh();
}

QString RebuildBar::text() const { return label_->text(); }

void RebuildBar::refresh() {
  const PendingRebuild& pending = document_.pendingRebuild();
  if (!pending.waits()) {
    patience_.stop();
    setVisible(false);
  } else if (const auto& f = pending.forecast()) {
    patience_.stop();
    label_->setText(forecastLine(*f));
    label_->setToolTip(partsText(*f));
    rebuild_->setEnabled(f->refused.empty());
    setVisible(true);
  } else if (!patience_.isActive()) {
    patience_.start();
  }
}

}  // namespace hl::ui
