// Starts the figures of the page. Curves belong to the replay before them.

scheme.begin();
let player;
document.querySelectorAll('figure.replay, figure.curves').forEach((figure) => {
  const data = dataOf(figure);
  if (figure.matches('.curves')) new Curves(figure, data, player);
  else if (data.runs.length && data.runs[0].times.data) player = new Player(figure, readReplay(data));
  else figure.querySelector('.stage').textContent = 'Nothing was recorded.';
});
document.querySelectorAll('figure.drawing, figure.chart').forEach(addImageButton);
