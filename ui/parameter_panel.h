#pragma once
// The parameter panel: built from declarations alone, with search, reset by group, and one signal for every change.
#include <QWidget>
#include <map>
#include <vector>

#include "ui/catalog.h"

class QLabel;
class QLineEdit;
class QToolButton;
class QVBoxLayout;

namespace hl::ui {

class ParameterRow;

class ParameterPanel : public QWidget {
  Q_OBJECT
 public:
  explicit ParameterPanel(QWidget* parent = nullptr);

  /// Replaces all rows; they show defaults until setValues().
  void setGroups(const std::vector<ParameterGroup>&);
  /// Values by key; keys that are missing show their default. Emits nothing.
  void setValues(const std::map<std::string, std::string>& values);
  /// Rows whose value is not in use yet, since it waits for a rebuild.
  void setWaiting(const std::map<std::string, std::string>& values);
  void search(const QString& words);

  /// Null where there is no such key.
  ParameterRow* row(const std::string& key) const;
  QToolButton* groupResetButton(const std::string& group) const;
  QLineEdit* searchBox() const { return search_; }

 signals:
  /// Some parameters were changed by the person, by key. All changes of one drag have the same non-zero number.
  void edited(const std::map<std::string, std::string>& texts, quint64 drag);
  void message(const QString& text);
  void sweepWanted(const std::string& key);

 private:
  struct Group {
    std::string id;
    QWidget* box = nullptr;
    QWidget* body = nullptr;
    QToolButton* header = nullptr;
    QToolButton* reset = nullptr;
    std::vector<ParameterRow*> rows;
  };
  void addGroup(const ParameterGroup&);
  void updateHeaders();

  QLineEdit* search_ = nullptr;
  QWidget* content_ = nullptr;
  QVBoxLayout* layout_ = nullptr;
  QLabel* nothing_ = nullptr;
  std::vector<Group> groups_;
  std::map<std::string, bool> collapsed_;  // kept when the technique changes
  quint64 drag_ = 0;
};

}  // namespace hl::ui
