#pragma once
// Error: how far the picture is from the reference, matched and full, now and over time.
#include <QTimer>
#include <QWidget>
#include <memory>

#include "engine/session/session.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QTableWidget;
class QTabWidget;

namespace hl::ui {

class EngineLink;
class ErrorPlot;
class WorkLine;

class ErrorPanel : public QWidget {
  Q_OBJECT
 public:
  explicit ErrorPanel(EngineLink&, QWidget* parent = nullptr);
  void showFrame(std::shared_ptr<const FrameResult>);
  /// Whether the reference is being traced; also turned on when someone asks to see it.
  void setReferenceWanted(bool);
  /// A page beside the table.
  void addPage(QWidget*, const QString& title);

 protected:
  void showEvent(QShowEvent*) override;

 private:
  void draw();
  void fillTable(const FrameResult&);

  EngineLink& link_;
  QCheckBox* wanted_;
  QComboBox* metric_;
  QComboBox* component_;
  QComboBox* axis_;
  QTableWidget* table_;
  QLabel* hint_;
  QTabWidget* pages_;
  ErrorPlot* plot_;
  WorkLine* work_;
  QTimer timer_;
  std::shared_ptr<const FrameResult> frame_;
};

}  // namespace hl::ui
