#include "ui/log_dock.h"

#include <QComboBox>
#include <QFontDatabase>
#include <QHBoxLayout>
#include <QLabel>
#include <QMetaObject>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QTime>
#include <QVBoxLayout>

namespace hl::ui {
namespace {

constexpr int kMostLines = 5000;

}  // namespace

LogPanel::LogPanel(QWidget* parent) : QWidget(parent), level_(new QComboBox(this)), text_(new QPlainTextEdit(this)) {
  auto* column = new QVBoxLayout(this);
  auto* line = new QHBoxLayout;
  level_->addItem(tr("Everything"), static_cast<int>(LogLevel::Debug));
  level_->addItem(tr("Information"), static_cast<int>(LogLevel::Info));
  level_->addItem(tr("Warnings"), static_cast<int>(LogLevel::Warning));
  level_->addItem(tr("Errors"), static_cast<int>(LogLevel::Error));
  level_->setCurrentIndex(1);
  auto* label = new QLabel(tr("Show"), this);
  label->setBuddy(level_);
  auto* clear = new QPushButton(tr("Clear"), this);
  line->addWidget(label);
  line->addWidget(level_);
  line->addStretch(1);
  line->addWidget(clear);
  column->addLayout(line);
  text_->setReadOnly(true);
  text_->setMaximumBlockCount(kMostLines);
  text_->setFont(QFontDatabase::systemFont(QFontDatabase::FixedFont));
  text_->setLineWrapMode(QPlainTextEdit::WidgetWidth);
  text_->setAccessibleName(tr("Log"));
  text_->setPlaceholderText(tr("Nothing has been reported."));
  column->addWidget(text_, 1);
  connect(level_, &QComboBox::currentIndexChanged, this, &LogPanel::refill);
  connect(clear, &QPushButton::clicked, this, [this] {
    lines_.clear();
    text_->clear();
  });
  setLogSink([this](LogLevel level, std::string_view message) {
    const QString text = QString::fromUtf8(message.data(), static_cast<qsizetype>(message.size()));
    QMetaObject::invokeMethod(this, [this, level, text] { add(level, text); }, Qt::QueuedConnection);
  });
}

LogPanel::~LogPanel() { setLogSink({}); }

void LogPanel::add(LogLevel level, const QString& text) {
  lines_.push_back({level, QTime::currentTime().toString(QStringLiteral("HH:mm:ss")), text});
  if (lines_.size() > kMostLines) lines_.pop_front();
  append(lines_.back());
}

void LogPanel::append(const Line& line) {
  if (static_cast<int>(line.level) < level_->currentData().toInt()) return;
  static const QStringList names{QStringLiteral("debug  "), QStringLiteral("info   "), QStringLiteral("warning"), QStringLiteral("error  ")};
  text_->appendPlainText(line.time + QStringLiteral("  ") + names[static_cast<int>(line.level)] + QStringLiteral("  ") + line.text);
}

void LogPanel::refill() {
  text_->clear();
  for (const Line& line : lines_) append(line);
}

}  // namespace hl::ui
