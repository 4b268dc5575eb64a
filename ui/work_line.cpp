#include "ui/work_line.h"

#include <QCoreApplication>
#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

namespace hl::ui {
namespace {

constexpr int kBarSteps = 1000;

}  // namespace

QString durationText(double seconds) {
  const auto tr = [](const char* text) { return QCoreApplication::translate("Duration", text); };
  const long long s = std::llround(std::max(0.0, seconds));
  if (s < 60) return tr("%1 s").arg(s);
  if (s < 3600) return tr("%1 min %2 s").arg(s / 60).arg(s % 60);
  return tr("%1 h %2 min").arg(s / 3600).arg(s / 60 % 60);
}

WorkLine::WorkLine(const QString& name, QWidget* parent)
    : QWidget(parent),
      name_(name),
      label_(new QLabel(this)),
      bar_(new QProgressBar(this)),
      cancel_(new QToolButton(this)),
      restart_(new QToolButton(this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(2);
  label_->setTextFormat(Qt::PlainText);
  label_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  column->addWidget(label_);
  auto* line = new QHBoxLayout;
  bar_->setRange(0, kBarSteps);
  bar_->setTextVisible(true);
  bar_->setAccessibleName(tr("Progress of %1").arg(name));
  line->addWidget(bar_, 1);
  cancel_->setText(tr("Cancel"));
  cancel_->setToolTip(tr("Stop; what was done so far stays"));
  restart_->setText(tr("Resume"));
  restart_->setToolTip(tr("Go on with what was cancelled"));
  line->addWidget(cancel_);
  line->addWidget(restart_);
  column->addLayout(line);
  connect(cancel_, &QToolButton::clicked, this, &WorkLine::cancelWanted);
  connect(restart_, &QToolButton::clicked, this, &WorkLine::restartWanted);
  show(WorkReport{});
}

void WorkLine::show(const WorkReport& work) {
  const bool complete = work.done >= 1;
  const bool said = work.label.empty() || name_.compare(QString::fromStdString(work.label), Qt::CaseInsensitive) == 0;
  QString text = said ? name_ : name_ + QStringLiteral(": ") + QString::fromStdString(work.label);
  if (work.running && work.secondsLeft >= 0)
    text += tr(", %1 left").arg(durationText(work.secondsLeft));
  else if (!work.running)
    text = complete ? (work.label.empty() ? tr("%1: nothing to do").arg(name_) : tr("%1: done").arg(name_)) : text;
  label_->setText(text);
  label_->setToolTip(text);
  bar_->setValue(static_cast<int>(std::lround(std::clamp(work.done, 0.0, 1.0) * kBarSteps)));
  bar_->setFormat(QStringLiteral("%1 %").arg(work.done * 100, 0, 'f', work.running ? 1 : 0));
  cancel_->setEnabled(work.running);
  restart_->setEnabled(!work.running && !complete && work.done > 0);
}

}  // namespace hl::ui
