#pragma once
// Log: everything the engine and the window report, newest last.
#include <QWidget>
#include <deque>

#include "engine/core/log.h"

class QComboBox;
class QPlainTextEdit;

namespace hl::ui {

class LogPanel : public QWidget {
  Q_OBJECT
 public:
  /// Receives the engine's log while it exists.
  explicit LogPanel(QWidget* parent = nullptr);
  ~LogPanel() override;
  void add(LogLevel, const QString& text);

 private:
  struct Line {
    LogLevel level;
    QString time, text;
  };
  void append(const Line&);
  void refill();

  QComboBox* level_;
  QPlainTextEdit* text_;
  std::deque<Line> lines_;
};

}  // namespace hl::ui
