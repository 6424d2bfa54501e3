// Exchanges the key behind # of the printed address for the address of a page of its own.

async function enter() {
  const answer = await fetch("/", { method: "POST", body: location.hash.slice(1) });
  if (answer.ok) location.replace(`/${await answer.text()}/`);
  else document.getElementById("problem").textContent = "This address has no valid key: open the address that the program printed.";
}
window.addEventListener("hashchange", enter);
enter();
