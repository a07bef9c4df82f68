// Shows the status once a second.
async function show() {
  const answer = await fetch("status" + location.search);
  document.getElementById("status").textContent = JSON.stringify(await answer.json(), null, 2);
}
setInterval(show, 1000);
show();
