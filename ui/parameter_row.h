#pragma once
// One parameter of the panel, made from its declaration: name with unit and help, slider and field (or list, or tick), what a change costs, reset.
#include <QObject>

#include "engine/params/param.h"
#include "ui/slider_scale.h"

class QCheckBox;
class QComboBox;
class QGridLayout;
class QLabel;
class QSlider;
class QToolButton;
class QWidget;

namespace hl::ui {

class ParameterField;

class ParameterRow : public QObject {
  Q_OBJECT
 public:
  /// Adds its widgets to row `line` of the grid (5 columns).
  ParameterRow(const ParamInfo&, QGridLayout&, int line, QWidget* parent);

  const ParamInfo& info() const { return info_; }
  std::string text() const { return text_; }
  /// Shows the value without emitting anything.
  void show(const std::string& text);
  void setVisible(bool);
  /// Its value waits for a rebuild.
  void setWaiting(bool);
  bool isDefault() const;
  /// Words of its name, key, unit, help and values.
  bool matches(const QString& words) const;

  QSlider* slider() const { return slider_; }
  ParameterField* field() const { return field_; }
  QComboBox* list() const { return list_; }
  QCheckBox* tick() const { return tick_; }
  QToolButton* resetButton() const { return reset_; }
  QLabel* nameLabel() const { return name_; }

 signals:
  /// `dragging`: one of many of the same drag.
  void edited(const std::string& text, bool dragging);
  void dragStarted();
  void message(const QString& text);
  void sweepWanted();

 private:
  void addNumber(QGridLayout&, int line);
  void addChoice(QGridLayout&, int line);
  void change(const std::string& text, bool dragging);
  void updateLook();
  QString toolTip() const;

  const ParamInfo& info_;
  SliderScale scale_;
  std::string text_;
  QLabel* name_ = nullptr;
  QLabel* cost_ = nullptr;
  QSlider* slider_ = nullptr;
  ParameterField* field_ = nullptr;
  QComboBox* list_ = nullptr;
  QCheckBox* tick_ = nullptr;
  QToolButton* reset_ = nullptr;
  QList<QWidget*> widgets_;
};

}  // namespace hl::ui
