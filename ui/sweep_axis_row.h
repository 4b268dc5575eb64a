#pragma once
// One axis of an experiment as it is typed: a list of values, a range, or the choices of what has names.
#include <QWidget>

#include "engine/params/param.h"
#include "ui/sweep_draft.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QLineEdit;
class QSpinBox;
class QStackedWidget;
class QToolButton;

namespace hl::ui {

/// What is wrong with a field, in one line under it; hidden while nothing is.
class FieldError : public QWidget {
  Q_OBJECT
 public:
  explicit FieldError(QWidget* parent = nullptr);
  void say(const QString& what);
  QString text() const;

 protected:
  void changeEvent(QEvent*) override;

 private:
  void colour();
  QLabel* label_;
};

class SweepAxisRow : public QWidget {
  Q_OBJECT
 public:
  /// `info`: its declaration, null for technique, camera and resolution. `choices`: names to tick, where only those will do; with their help.
  SweepAxisRow(const DraftAxis&, const ParamInfo* info, const std::vector<std::pair<std::string, std::string>>& choices, QWidget* parent);
  DraftAxis axis() const;
  const std::string& key() const { return key_; }
  void say(const QString& problem) { error_->say(problem); }
  QString problem() const { return error_->text(); }
  /// To where the values are typed.
  void takeFocus();

 signals:
  void edited();
  void removeWanted();

 private:
  QWidget* makeNumbers(const DraftAxis&, const ParamInfo&);
  QWidget* makeChoices(const DraftAxis&, const std::vector<std::pair<std::string, std::string>>&);
  void showMode();

  std::string key_;
  QComboBox* mode_ = nullptr;      // list or range; null where only a list will do
  QStackedWidget* pages_ = nullptr;
  QLineEdit* values_ = nullptr;
  QLineEdit* from_ = nullptr;
  QLineEdit* to_ = nullptr;
  QSpinBox* count_ = nullptr;
  QCheckBox* log_ = nullptr;
  std::vector<QCheckBox*> choices_;
  FieldError* error_ = nullptr;
};

/// A good first guess for an axis of a parameter: its soft range in four steps, or all of its values.
DraftAxis suggestedAxis(const ParamInfo&);

}  // namespace hl::ui
