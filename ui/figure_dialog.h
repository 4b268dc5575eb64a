#pragma once
// What goes into a figure: pictures with their captions, metrics, and regions to enlarge.
#include <QDialog>
#include <QThreadPool>

#include "ui/compare.h"
#include "ui/figure.h"

class QComboBox;
class QLabel;
class QListWidget;
class QPushButton;

namespace hl::ui {

class FigureDialog : public QDialog {
  Q_OBJECT
 public:
  FigureDialog(Compare&, Document&, ImageFeed&, QWidget* parent = nullptr);
  ~FigureDialog() override;
  /// As chosen now.
  FigureSheet figure() const;
  /// In a worker thread; answered by written() or refused().
  void write(const QString& path);

 signals:
  void written(const QString& path);
  void refused(const QString& why);

 private:
  void wantImages();
  PicturePart part() const;
  void choosePath();

  Compare& compare_;
  Document& document_;
  ImageFeed& feed_;
  QListWidget *pictures_, *metrics_, *insets_;
  QComboBox *component_, *truth_;
  QLabel* message_;
  QPushButton* export_;
  QThreadPool worker_;
};

}  // namespace hl::ui
