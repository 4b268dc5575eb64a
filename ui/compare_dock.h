#pragma once
// Compare: what stands as A and B, how they are shown, and the snapshots.
#include <QWidget>

#include "ui/compare.h"

class QBoxLayout;
class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QListWidget;
class QPushButton;
class QSlider;

namespace hl::ui {

class ComparePanel : public QWidget {
  Q_OBJECT
 public:
  ComparePanel(Compare&, Document&, QWidget* parent = nullptr);
  QSize minimumSizeHint() const override { return {200, 120}; }

 protected:
  void resizeEvent(QResizeEvent*) override;

 private:
  QWidget* makeChoices();
  QWidget* makeSnapshots();
  void readChoice();
  void readSources();
  void readParts();
  void readSnapshots();
  void showFacts();
  void changed();
  int selected() const;  ///< a snapshot's id; 0 none

  Compare& compare_;
  Document& document_;
  QBoxLayout* halves_;
  QComboBox *mode_, *a_, *b_, *component_, *metric_;
  QSlider *wipe_, *gain_;
  QDoubleSpinBox* rate_;
  QLabel *wipeLabel_, *gainLabel_, *rateLabel_, *metricLabel_, *message_;
  QListWidget* list_;
  QLabel *memory_, *facts_;
  QPushButton *rename_, *remove_, *restore_;
  bool filling_ = false;
};

}  // namespace hl::ui
