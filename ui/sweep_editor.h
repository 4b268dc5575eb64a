#pragma once
// An experiment being written: base, axes, how it is measured, where its results go. What is typed is checked on a worker by the reader of experiments'
// files; what it says stands under the field it is about.
#include <QThreadPool>
#include <QTimer>
#include <QWidget>
#include <functional>
#include <map>

#include "ui/document.h"
#include "ui/settings.h"
#include "ui/sweep_draft.h"

class QBoxLayout;
class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QLineEdit;
class QMenu;
class QPushButton;
class QSpinBox;
class QToolButton;
class QVBoxLayout;

namespace hl::ui {

class FieldError;
class SweepAxisRow;

class SweepEditor : public QWidget {
  Q_OBJECT
 public:
  SweepEditor(Document&, Settings&, QWidget* parent = nullptr);
  ~SweepEditor() override;

  SweepDraft draft() const;
  void setDraft(const SweepDraft&, const QString& name);
  /// Varies the parameter, over its soft range, in the set that is shown; where it is varied already, goes to it.
  void addAxis(const std::string& key);
  /// An experiment's file, or the name of one that came with the program.
  void openExperiment(const QString& nameOrPath);
  /// Writes the experiment as `bench` takes it, once it is found to be right.
  void saveTo(const QString& path);
  void setBaseFile(const QString& path);
  void setFolder(const QString&);
  QString folder() const;
  QString name() const;
  void start();
  /// What is wrong, where it stands; "" while nothing is, or nothing was checked yet.
  QString problemAt(const DraftField&) const;
  /// What is told is of what is typed: no check is due or under way.
  bool upToDate() const { return !checkTimer_.isActive() && answered_ == asked_; }
  SweepAxisRow* axisRow(const std::string& key) const;

 signals:
  void startWanted(const QString& name, const hl::Experiment& experiment, const QString& folder);
  void message(const QString& text);
  void refused(const QString& why);
  /// The answer to an edit, an opening or a saving is there.
  void checked();
  void saved(const QString& path);
  void opened(const QString& path);

 protected:
  void resizeEvent(QResizeEvent*) override;

 private:
  enum class Then { Nothing, Start, Save };
  QWidget* makeAxes();
  QWidget* makeMeasures();
  QLayout* makeFiles();
  QLayout* makeSeeds(QWidget* box);
  QLayout* makeStop(QWidget* box);
  FieldError* errorLine(const QString& field, QWidget* parent);
  void fillAxes();
  void fillKeys();
  void fillMetricsMenu();
  void keepSet();
  void showSet(int set);
  void showBase();
  void showStop();
  void edited();
  void check(Then, const QString& path = {});
  void takeCheck(const DraftCheck&, Then, const QString& path, quint64 number);
  void showProblem(const std::optional<DraftProblem>&);
  void followName();
  Preset windowPreset() const;
  /// On the worker; an exception comes back as refused(), else `then` runs in the window's thread.
  template <class T>
  void later(std::function<T()> work, std::function<void(const T&)> then);

  Document& document_;
  Settings& settings_;
  std::optional<Preset> baseFile_;  ///< none: the window's
  QString baseName_;
  std::vector<std::vector<DraftAxis>> sets_ = {{}};
  size_t set_ = 0;
  bool folderChosen_ = false;

  QBoxLayout* halves_ = nullptr;
  QComboBox* base_ = nullptr;
  QComboBox* setChooser_ = nullptr;
  QToolButton* removeSet_ = nullptr;
  QComboBox* keys_ = nullptr;
  QVBoxLayout* axes_ = nullptr;
  QLabel* noAxes_ = nullptr;
  std::vector<SweepAxisRow*> rows_;
  QMenu* shipped_ = nullptr;
  QMenu* metricsMenu_ = nullptr;
  QLineEdit* name_ = nullptr;
  QLineEdit* seeds_ = nullptr;
  QSpinBox* repeats_ = nullptr;
  QLineEdit* metrics_ = nullptr;
  QCheckBox* matched_ = nullptr;
  QCheckBox* full_ = nullptr;
  QComboBox* stop_ = nullptr;
  QDoubleSpinBox* stopAmount_ = nullptr;
  QDoubleSpinBox* limit_ = nullptr;
  QSpinBox* amortise_ = nullptr;
  QCheckBox* pathTracer_ = nullptr;
  QCheckBox* lightmap_ = nullptr;
  double targetError_ = 0;  ///< as the file has it
  QCheckBox* images_ = nullptr;
  QLineEdit* folder_ = nullptr;
  QLabel* count_ = nullptr;
  QPushButton* start_ = nullptr;
  std::map<QString, FieldError*> errors_;
  std::optional<DraftProblem> problem_;
  QTimer checkTimer_;
  QThreadPool worker_;
  quint64 asked_ = 0, answered_ = 0;
  bool filling_ = false;
};

}  // namespace hl::ui
