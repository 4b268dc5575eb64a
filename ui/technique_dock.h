#pragma once
// Technique: which one, its parameters, the bake's progress, and its passes with why any was skipped.
#include <QWidget>

#include "ui/document.h"

class QComboBox;
class QLabel;

namespace hl::ui {

class ParameterPanel;
class PassModel;
class WorkLine;

class TechniquePanel : public QWidget {
  Q_OBJECT
 public:
  TechniquePanel(Document&, EngineLink&, PassModel&, QWidget* parent = nullptr);
  void showFrame(const FrameResult&);
  ParameterPanel& parameters() { return *parameters_; }
  QComboBox& chooser() { return *chooser_; }

 signals:
  void message(const QString& text);

 private:
  void readTechnique();

  Document& document_;
  QComboBox* chooser_;
  QLabel* summary_;
  ParameterPanel* parameters_;
  WorkLine* work_;
  std::string shown_;
};

}  // namespace hl::ui
